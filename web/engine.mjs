// SPDX-License-Identifier: Apache-2.0
// The SPARQL engine of the page: oxigraph without its GeoSPARQL functions. They take coordinates as longitude and latitude,
// and those of a map are metres: the numbers would be wrong. A function that the engine does not know is a fault instead.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

const FUNCTIONS = 'http://www.opengis.net/def/function/geosparql/';
const SPACE = 0x20;

/** The engine's program with each of these functions under a name that no query can write: no IRI has a space in it. */
export function engineBytes(folder) {
  const bytes = readFileSync(join(folder, 'node_modules/oxigraph/web_bg.wasm'));
  let at = bytes.indexOf(FUNCTIONS);
  if (at < 0) throw new Error('oxigraph/web_bg.wasm does not name the GeoSPARQL functions as before: change web/engine.mjs');
  for (; at >= 0; at = bytes.indexOf(FUNCTIONS, at)) bytes[at] = SPACE;
  return bytes;
}
