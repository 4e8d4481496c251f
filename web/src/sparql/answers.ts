// SPDX-License-Identifier: Apache-2.0
// Answers as values that pass between the page and the worker.
import type { UnknownName } from './names';

export interface RdfTerm {
  kind: 'iri' | 'blank' | 'literal';
  value: string;
  datatype?: string;
  language?: string;
}
/** A cell is null where the variable is unbound. */
export interface Rows { form: 'rows'; variables: string[]; rows: (RdfTerm | null)[][] }
export interface Truth { form: 'truth'; value: boolean }
export interface Graph { form: 'graph'; triples: RdfTerm[][] }
/**
 * `unknown`: names in the question that the page's quads do not have. `unbound`: its variables that nothing binds.
 * `doubts`: what texts that it makes of values may be written otherwise by `cluxel query`.
 */
export type Answer = (Rows | Truth | Graph) &
  { milliseconds: number; unknown: UnknownName[]; unbound: string[]; doubts: ('texts' | 'joined')[] };

export interface Load { kind: 'load'; engine: ArrayBuffer; terms: string; quads: ArrayBuffer }
export interface Ask { kind: 'ask'; id: number; text: string }
export type ToWorker = Load | Ask;
export type FromWorker =
  | { kind: 'loaded'; quads: number; milliseconds: number }
  | { kind: 'answer'; id: number; answer: Answer }
  | { kind: 'fault'; id: number; message: string };
