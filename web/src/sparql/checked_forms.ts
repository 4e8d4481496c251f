// SPDX-License-Identifier: Apache-2.0
// The forms of times and numbers that the page can give back. The engine keeps them by their value, so that 1.50, 5.0E-1
// and a time in another zone or with fewer digits lose their text.
import { objectsOf } from './packed_quads';

const XSD = 'http://www.w3.org/2001/XMLSchema#';
/** Of datatypes that the engine reads, the texts as Cluxel writes them. Others of XSD have no such form. */
const FORMS: Record<string, RegExp> = {
  string: /^/,
  anyURI: /^/,
  boolean: /^(true|false)$/,
  integer: /^(0|-?[1-9]\d{0,17})$/,
  decimal: /^(?!-0\.0$)(?!.{19})-?(0|[1-9]\d*)\.(\d*[1-9]|0)$/,
  dateTime: /^\d{4}-\d\d-\d\dT([01]\d|2[0-3]):[0-5]\d:[0-5]\d\.\d{6}Z$/,
};

/** Whether the text of a term in N-Triples is known from what the engine keeps of it. */
export function hasCheckedForm(term: string): boolean {
  const cut = term.startsWith('"') ? term.lastIndexOf(`"^^<${XSD}`) : -1;
  return cut < 0 || (FORMS[term.slice(cut + 4 + XSD.length, -1)]?.test(term.slice(1, cut)) ?? false);
}

/** The properties that have a value of another form, such as probabilities that an ontology writes as 0.20. */
export function uncheckedProperties(termText: string, quads: Uint8Array): Set<string> {
  const terms = termText.split('\n'), unchecked = new Set<number>(), found = new Set<number>();
  terms.forEach((term, i) => {
    if (!hasCheckedForm(term)) unchecked.add(i);
  });
  if (unchecked.size > 0) for (const [property, object] of objectsOf(quads)) if (unchecked.has(object)) found.add(property);
  return new Set([...found].map((property) => terms[property].slice(1, -1)));
}
