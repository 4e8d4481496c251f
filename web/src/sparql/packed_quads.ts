// SPDX-License-Identifier: Apache-2.0
// Unpacks the map's quads (src/tasks/view/packed_quads.hpp) into N-Quads, some thousand lines at a time.

const LINES_IN_PIECE = 20_000;

/** Reads LEB128 numbers. */
class Numbers {
  private at = 0;
  constructor(private readonly bytes: Uint8Array) {}

  get isAtEnd(): boolean {
    return this.at >= this.bytes.length;
  }

  next(): number {
    let value = 0, scale = 1;
    for (;;) {
      const byte = this.bytes[this.at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  }
}

export function* nquadsOf(termText: string, quads: Uint8Array): Generator<string> {
  const terms = termText.split('\n'), numbers = new Numbers(quads);
  let lines: string[] = [];
  while (!numbers.isAtEnd) {
    const graph = terms[numbers.next()], count = numbers.next();
    let subject = 0;
    for (let i = 0; i < count; ++i) {
      subject += numbers.next();
      lines.push(`${terms[subject]} ${terms[numbers.next()]} ${terms[numbers.next()]} ${graph} .\n`);
      if (lines.length < LINES_IN_PIECE) continue;
      yield lines.join('');
      lines = [];
    }
  }
  yield lines.join('');
}

/** The property and the object of each quad, as places among the terms. */
export function* objectsOf(quads: Uint8Array): Generator<[number, number]> {
  const numbers = new Numbers(quads);
  while (!numbers.isAtEnd) {
    numbers.next();  // the graph
    for (let left = numbers.next(); left > 0; --left) {
      numbers.next();  // the subject
      yield [numbers.next(), numbers.next()];
    }
  }
}
