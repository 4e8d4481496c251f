// SPDX-License-Identifier: Apache-2.0
// The engine stores times by their value and tells them in the shortest form. A question to `cluxel query` compares the
// text, so that answers give times as the map writes them.

const TIME = /^"([^"\\]*)"\^\^<http:\/\/www\.w3\.org\/2001\/XMLSchema#dateTime>$/gm;

/** As the engine writes a time: without zeros at the end of the fraction. */
export const shortTime = (time: string): string => time.replace(/\.(\d*?)0*(?=[^\d]|$)/, (_, digits) => (digits ? `.${digits}` : ''));

/** By their short form the times among N-Triples terms, one a line. */
export function timesIn(terms: string): Map<string, string> {
  const times = new Map<string, string>();
  for (const [, time] of terms.matchAll(TIME)) if (!times.has(shortTime(time))) times.set(shortTime(time), time);
  return times;
}
