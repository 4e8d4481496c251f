// SPDX-License-Identifier: Apache-2.0
// Runs oxigraph beside the page, so that a long question leaves the page usable. The default graph is that of
// `cluxel query`: the union of all graphs, or what FROM names.
import init, { Store } from 'oxigraph/web.js';
import type { Answer, Ask, FromWorker, Load, RdfTerm, ToWorker } from './answers';
import { uncheckedProperties } from './checked_forms';
import { namesDataset } from './dataset';
import { timesIn } from './lexical_times';
import { missingPrefixes, namesIn, unboundIn, undeclaredPrefix, type UnknownName } from './names';
import { nquadsOf } from './packed_quads';
import { readsAnyOf, withStoredText } from './stored_text';

interface EngineTerm {
  termType: string;
  value: string;
  datatype?: { value: string };
  language?: string;
}

/**
 * The map, and a store without quads, which tells the form of a query at once. `unchecked`: the properties with values of
 * which the engine loses the text.
 */
interface Stores { map: Store; blank: Store; times: Map<string, string>; unchecked: Set<string> }

const DATE_TIME = 'http://www.w3.org/2001/XMLSchema#dateTime';
const UNKNOWN_FUNCTION = /^The custom function <(.*)> is not supported$/;

let stores: Stores | undefined;
const scope = self as unknown as { postMessage(message: FromWorker): void };

async function load(message: Load): Promise<void> {
  const start = performance.now();
  await init({ module_or_path: await WebAssembly.compile(message.engine) });
  const map = new Store();
  const quads = new Uint8Array(message.quads);
  for (const piece of nquadsOf(message.terms, quads))
    map.load(piece, { format: 'application/n-quads', no_transaction: true, lenient: true });
  stores = { map, blank: new Store(), times: timesIn(message.terms), unchecked: uncheckedProperties(message.terms, quads) };
  scope.postMessage({ kind: 'loaded', quads: map.size, milliseconds: performance.now() - start });
}

function termOf(term: EngineTerm | undefined, times: Map<string, string>): RdfTerm | null {
  if (!term) return null;
  if (term.termType === 'NamedNode') return { kind: 'iri', value: term.value };
  if (term.termType === 'BlankNode') return { kind: 'blank', value: term.value };
  const value = (term.datatype?.value === DATE_TIME && times.get(term.value)) || term.value;
  return { kind: 'literal', value, datatype: term.datatype?.value, language: term.language || undefined };
}

/** The variables of a SELECT in their order: the engine's solutions leave out unbound ones. */
function variablesOf(blank: Store, text: string): string[] {
  const csv = blank.query(text, { results_format: 'csv' }) as unknown as string;
  const head = csv.slice(0, csv.search(/\r?\n/));
  return head === '' ? [] : head.split(',');
}

/** Whether the query is a CONSTRUCT or DESCRIBE: only a graph can be written as triples. */
function makesGraph(blank: Store, text: string): boolean {
  try {
    blank.query(text, { results_format: 'nt' });
    return true;
  } catch {
    return false;
  }
}

/** Whether the text has no fault of syntax. */
function isReadable(blank: Store, text: string): boolean {
  try {
    blank.query(text);
    return true;
  } catch (fault) {
    return !/^error at \d/.test(messageOf(fault));
  }
}

/** The names that no quad has. */
function unknownNames(map: Store, text: string): UnknownName[] {
  return namesIn(text).filter(({ what, iri }) => {
    const name = `<${iri}>`, quads = [`?s ${name} ?o`, `?s ?p ${name}`, `${name} ?p ?o`].map((pattern) => `{ ${pattern} }`);
    const isKnown = what === 'graph' ? `GRAPH ${name} { ?s ?p ?o }` : quads.join(' UNION ');
    return map.query(`ASK { ${isKnown} }`, { use_default_graph_as_union: true }) === false;
  });
}

/** The question for the engine, and what `cluxel query` may write otherwise in the texts that it makes. */
function askable(blank: Store, text: string, unchecked: Set<string>): { asked: string; doubts: Answer['doubts'] } {
  const stored = withStoredText(text), isKept = isReadable(blank, stored.text);  // a label of a blank node may stand once
  const doubts: Answer['doubts'] = [];
  const isSure = isKept && stored.isWhole && !stored.isDoubtful && !readsAnyOf(unchecked, text);
  if (stored.makesText && !isSure) doubts.push('texts');
  if (stored.joinsDistinct) doubts.push('joined');
  return { asked: isKept ? stored.text : text, doubts };
}

function answerOf({ map, blank, times, unchecked }: Stores, written: string): Answer {
  const start = performance.now(), text = missingPrefixes(written) + written;
  const isUnion = !namesDataset(text, (changed) => isReadable(blank, changed));
  if (!isReadable(blank, text)) blank.query(text);  // throws with the places of the question as it was written
  const { asked, doubts } = askable(blank, text, unchecked);
  const result = map.query(asked, { use_default_graph_as_union: isUnion }) as unknown;
  const milliseconds = performance.now() - start, unknown = unknownNames(map, written);
  const timed = (answer: object) => ({ ...answer, milliseconds, unknown, unbound: unboundIn(written), doubts }) as Answer;
  if (typeof result === 'boolean') return timed({ form: 'truth', value: result });
  if (makesGraph(blank, text)) {
    const quads = result as { subject: EngineTerm; predicate: EngineTerm; object: EngineTerm }[];
    const triples = quads.map((quad) => [quad.subject, quad.predicate, quad.object].map((term) => termOf(term, times)!));
    return timed({ form: 'graph', triples });
  }
  const solutions = result as Map<string, EngineTerm>[], variables = variablesOf(blank, text);
  const rows = solutions.map((solution) => variables.map((name) => termOf(solution.get(name), times)));
  return timed({ form: 'rows', variables, rows });
}

const messageOf = (fault: unknown): string => (fault instanceof Error ? fault.message : String(fault));

/**
 * The engine's words, but for prefixes that nothing declares, and functions that `cluxel query` has and the page has
 * not. Its places count the PREFIX lines that were put before the question.
 */
function toldFault(fault: unknown, text: string): string {
  const undeclared = /Prefix not found/.test(messageOf(fault)) ? undeclaredPrefix(text) : undefined;
  if (undeclared)
    return `error at ${undeclared.line}:${undeclared.column}: the prefix ${undeclared.prefix}: is not declared; ` +
      `begin the question with PREFIX ${undeclared.prefix}: <…>`;
  const unknown = UNKNOWN_FUNCTION.exec(messageOf(fault));
  if (!unknown)
    return messageOf(fault).replace(/^error at 1:(\d+)/, (_, column) => `error at 1:${Number(column) - missingPrefixes(text).length}`);
  return `The page has no function <${unknown[1]}>. Ask with cluxel query: it has the functions of GeoSPARQL and Cluxel.`;
}

function ask(message: Ask): void {
  if (!stores) return scope.postMessage({ kind: 'fault', id: message.id, message: 'The map is not loaded yet.' });
  try {
    scope.postMessage({ kind: 'answer', id: message.id, answer: answerOf(stores, message.text) });
  } catch (fault) {
    scope.postMessage({ kind: 'fault', id: message.id, message: toldFault(fault, message.text) });
  }
}

self.onmessage = (event: MessageEvent<ToWorker>) => {
  if (event.data.kind === 'ask') return ask(event.data);
  load(event.data).catch((fault) => scope.postMessage({ kind: 'fault', id: -1, message: String(fault) }));
};
