// SPDX-License-Identifier: Apache-2.0
// Runs oxigraph beside the page, so that a long question leaves the page usable. The default graph is the union of all
// graphs, as for `cluxel query`.
import init, { Store } from 'oxigraph/web.js';
import type { Answer, Ask, FromWorker, Load, RdfTerm, ToWorker } from './answers';
import { nquadsOf } from './packed_quads';

interface EngineTerm {
  termType: string;
  value: string;
  datatype?: { value: string };
  language?: string;
}

let store: Store | undefined;
const scope = self as unknown as { postMessage(message: FromWorker): void };

async function load(message: Load): Promise<void> {
  const start = performance.now();
  await init({ module_or_path: await WebAssembly.compile(message.engine) });
  store = new Store();
  for (const piece of nquadsOf(message.terms, new Uint8Array(message.quads)))
    store.load(piece, { format: 'application/n-quads', no_transaction: true, lenient: true });
  scope.postMessage({ kind: 'loaded', quads: store.size, milliseconds: performance.now() - start });
}

function termOf(term: EngineTerm | undefined): RdfTerm | null {
  if (!term) return null;
  if (term.termType === 'NamedNode') return { kind: 'iri', value: term.value };
  if (term.termType === 'BlankNode') return { kind: 'blank', value: term.value };
  return { kind: 'literal', value: term.value, datatype: term.datatype?.value, language: term.language || undefined };
}

/** The variables of a SELECT in their order: the engine's solutions leave out unbound ones. */
function variablesOf(engine: Store, text: string): string[] {
  const json = engine.query(text, { use_default_graph_as_union: true, results_format: 'csv' }) as unknown as string;
  const head = json.slice(0, json.search(/\r?\n/));
  return head === '' ? [] : head.split(',');
}

function answerOf(engine: Store, text: string): Answer {
  const start = performance.now();
  const result = engine.query(text, { use_default_graph_as_union: true }) as unknown;
  const timed = (answer: Answer | Omit<Answer, 'milliseconds'>) =>
    ({ ...answer, milliseconds: performance.now() - start }) as Answer;
  if (typeof result === 'boolean') return timed({ form: 'truth', value: result } as Answer);
  const items = result as (Map<string, EngineTerm> | { subject: EngineTerm; predicate: EngineTerm; object: EngineTerm })[];
  if (items.length > 0 && !(items[0] instanceof Map)) {
    const quads = items as { subject: EngineTerm; predicate: EngineTerm; object: EngineTerm }[];
    const triples = quads.map((quad) => [quad.subject, quad.predicate, quad.object].map((term) => termOf(term)!));
    return timed({ form: 'graph', triples } as Answer);
  }
  const solutions = items as Map<string, EngineTerm>[], variables = variablesOf(engine, text);
  const rows = solutions.map((solution) => variables.map((name) => termOf(solution.get(name))));
  return timed({ form: 'rows', variables, rows } as Answer);
}

function ask(message: Ask): void {
  if (!store) return scope.postMessage({ kind: 'fault', id: message.id, message: 'The map is not loaded yet.' });
  try {
    scope.postMessage({ kind: 'answer', id: message.id, answer: answerOf(store, message.text) });
  } catch (fault) {
    const text = fault instanceof Error ? fault.message : String(fault);
    scope.postMessage({ kind: 'fault', id: message.id, message: text });
  }
}

self.onmessage = (event: MessageEvent<ToWorker>) => {
  if (event.data.kind === 'ask') return ask(event.data);
  load(event.data).catch((fault) => scope.postMessage({ kind: 'fault', id: -1, message: String(fault) }));
};
