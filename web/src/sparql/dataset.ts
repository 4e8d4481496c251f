// SPDX-License-Identifier: Apache-2.0
// Whether a query names its dataset: the engine's union of all graphs would override FROM.

/** FROM where a clause may begin. Comments and texts are among these places; variables, IRIs and other names are not. */
const CANDIDATE = /(?<![^\s)}*>])(?<!\\.)from(?=[\s<#])/gi;

/**
 * Whether a query has FROM clauses. The engine's parser decides: where a clause begins, one more clause can be read, and
 * a brace cannot. In a comment or a text both can, and in all other places neither.
 */
export function namesDataset(text: string, isReadable: (text: string) => boolean): boolean {
  return [...text.matchAll(CANDIDATE)].some(({ index }) => {
    const before = text.slice(0, index), from = text.slice(index);
    return isReadable(`${before}FROM <urn:graph> ${from}`) && !isReadable(`${before}FROM { ${from}`);
  });
}
