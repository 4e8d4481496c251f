// SPDX-License-Identifier: Apache-2.0
// Shipped questions with values for their parameters, as text that any SPARQL engine runs.
import { CLX, type Question } from '../data/model';

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/;

/** A value as `cluxel query --param` reads it: <iri>, clx:Name, a number, else a string. */
export function termText(value: string): string {
  const written = value.trim();
  if (/^<[^<>"{}|^`\\\s]+>$/.test(written)) return written;
  if (/^clx:[A-Za-z][A-Za-z0-9_]*$/.test(written)) return `<${CLX}${written.slice(4)}>`;
  if (NUMBER.test(written)) return decimalText(written);
  return JSON.stringify(written);
}

/** "10" as the decimal 10.0: whole numbers alone would be integers, which divide otherwise. */
function decimalText(number: string): string {
  if (/[eE]/.test(number)) return number;
  const [, sign, whole, fraction] = /^([+-]?)(\d*)\.?(\d*)$/.exec(number)!;
  return `${sign}${whole || '0'}.${fraction || '0'}`;
}

/** The text without its header lines, which describe the question for tables and forms. */
export function bodyOf(question: Question): string {
  return question.text.split('\n').filter((line) => !line.startsWith('#!')).join('\n').trim();
}

/** The query with a VALUES line that binds the parameters at the beginning of the WHERE group. */
export function withValues(question: Question, values: Map<string, string>): string {
  const body = bodyOf(question);
  if (question.parameters.length === 0) return body;
  const names = question.parameters.map((parameter) => `?${parameter.name}`).join(' ');
  const terms = question.parameters.map((parameter) => termText(values.get(parameter.name) ?? parameter.value));
  return body.replace(/(\bWHERE\s*\{)/i, `$1\n  VALUES (${names}) { (${terms.join(' ')}) }`);
}
