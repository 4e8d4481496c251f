// SPDX-License-Identifier: Apache-2.0
// The engine stores times by their value and tells them in the shortest form. A question to `cluxel query` compares the
// text, so that answers give times as the map writes them.

const FULL_TIME = /^\d+-\d\d-\d\dT[\d:]+\.\d{6}Z$/;
const TIME = /^"([^"\\]*)"\^\^<http:\/\/www\.w3\.org\/2001\/XMLSchema#dateTime>$/gm;

/** As the engine writes a time: without zeros at the end of the fraction. */
export const shortTime = (time: string): string => time.replace(/\.(\d*?)0*(?=[^\d]|$)/, (_, digits) => (digits ? `.${digits}` : ''));

/** Whether all times among N-Triples terms are as Cluxel writes them, so that their text follows from the engine's. */
export const areFullTimes = (terms: string): boolean => [...terms.matchAll(TIME)].every(([, time]) => FULL_TIME.test(time));

/** By their short form the times among N-Triples terms, one a line. */
export function timesIn(terms: string): Map<string, string> {
  const times = new Map<string, string>();
  for (const [, time] of terms.matchAll(TIME)) if (!times.has(shortTime(time))) times.set(shortTime(time), time);
  return times;
}
