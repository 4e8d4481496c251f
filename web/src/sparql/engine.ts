// SPDX-License-Identifier: Apache-2.0
// The page's side of the SPARQL engine: starts the worker when it is first needed, and can stop a long question.
import { blockBytes, blockText } from '../data/blocks';
import type { Answer, FromWorker, ToWorker } from './answers';

interface Waiting { resolve(answer: Answer): void; reject(fault: Error): void }

export class Engine {
  private worker: Promise<Worker> | undefined;
  private readonly waiting = new Map<number, Waiting>();
  private nextId = 0;
  private parts: { engine: ArrayBuffer; terms: string; quads: ArrayBuffer; program: string } | undefined;

  /** Loads the map into the engine. Asking does it too. */
  start(): Promise<Worker> {
    this.worker ??= this.load();
    return this.worker;
  }

  async ask(text: string): Promise<Answer> {
    const worker = await this.start(), id = this.nextId++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      worker.postMessage({ kind: 'ask', id, text } satisfies ToWorker);
    });
  }

  /** Ends all questions that run. The next question loads the map again. */
  async stop(): Promise<void> {
    const worker = await this.worker;
    worker?.terminate();
    this.worker = undefined;
    for (const { reject } of this.waiting.values()) reject(new Error('The question was stopped.'));
    this.waiting.clear();
  }

  private async load(): Promise<Worker> {
    this.parts ??= {
      engine: (await blockBytes('engine')).buffer, terms: await blockText('terms'),
      quads: (await blockBytes('quads')).buffer, program: await blockText('worker'),
    };
    const url = URL.createObjectURL(new Blob([this.parts.program], { type: 'text/javascript' }));
    const worker = new Worker(url);
    const { engine, terms, quads } = this.parts;
    return new Promise((resolve, reject) => {
      worker.onerror = (event) => reject(new Error(`The SPARQL engine did not start: ${event.message}`));
      worker.onmessage = (event: MessageEvent<FromWorker>) => {
        URL.revokeObjectURL(url);
        if (event.data.kind === 'fault') return reject(new Error(event.data.message));
        worker.onmessage = (next: MessageEvent<FromWorker>) => this.receive(next.data);
        resolve(worker);
      };
      worker.postMessage({ kind: 'load', engine, terms, quads } satisfies ToWorker);
    });
  }

  private receive(message: FromWorker): void {
    if (message.kind === 'loaded') return;
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.kind === 'answer') waiting?.resolve(message.answer);
    else waiting?.reject(new Error(message.message));
  }
}
