// SPDX-License-Identifier: Apache-2.0
// Reads the blocks of data that stand in the page: base64 of gzip in script elements that no browser runs.

/** The bytes of a base64 text. */
function decoded(text: string): Uint8Array<ArrayBuffer> {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function unpacked(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export function hasBlock(id: string): boolean {
  return document.getElementById(id) !== null;
}

/** The bytes of the block `id`. With `drop` the element gives its text free: each block is read once. */
export async function blockBytes(id: string, drop = true): Promise<Uint8Array<ArrayBuffer>> {
  const element = document.getElementById(id);
  if (!element) throw new Error(`This page has no data '${id}'. Write it anew with cluxel view.`);
  const packed = decoded(element.textContent ?? '');
  if (drop) element.textContent = '';
  return unpacked(packed);
}

export async function blockText(id: string, drop = true): Promise<string> {
  return new TextDecoder().decode(await blockBytes(id, drop));
}

export async function blockJson<T>(id: string): Promise<T> {
  return JSON.parse(await blockText(id)) as T;
}
