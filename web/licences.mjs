// SPDX-License-Identifier: Apache-2.0
// The licences of the packages whose code is in the page: those that package.json depends on, with what they bring.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

const mit = (holder) => `MIT License

Copyright (c) ${holder}

Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit
persons to whom the Software is furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all copies or substantial portions of the
Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.`;

/** Packages under the MIT licence that hold no licence file name their holders here. */
const holders = {
  '@zazuko/yasgui-utils': 'Laurens Rietveld, Triply and Zazuko GmbH',
  '@zazuko/yasqe': 'Laurens Rietveld, Triply and Zazuko GmbH',
  oxigraph: 'the Oxigraph developers (chosen from "MIT OR Apache-2.0")',
};

/** What the page changes in a package. */
const changes = { oxigraph: ', changed: without GeoSPARQL functions' };

/** The names of packages that are not for development only, from the lock file. */
function shippedPackages(folder) {
  const lock = JSON.parse(readFileSync(join(folder, 'package-lock.json'), 'utf8'));
  return Object.entries(lock.packages)
    .filter(([path, entry]) => path !== '' && !entry.dev && !entry.devOptional && !entry.optional)
    .map(([path]) => path)
    .sort();
}

function licenceOf(path, name, said) {
  const file = readdirSync(path).find((entry) => /^licen[cs]e(\.md|\.txt)?$/i.test(entry));
  if (file) return readFileSync(join(path, file), 'utf8').trim();
  if (holders[name]) return mit(holders[name]);
  throw new Error(`${name} (${said}) has no licence file: name its holder in web/licences.mjs`);
}

export function licenceText(folder) {
  const texts = [];
  for (const path of shippedPackages(folder)) {
    const full = join(folder, path);
    if (!existsSync(full)) continue;
    const about = JSON.parse(readFileSync(join(full, 'package.json'), 'utf8'));
    texts.push(`${about.name} ${about.version} (${about.license})${changes[about.name] ?? ''}\n\n${licenceOf(full, about.name, about.license)}`);
  }
  return texts.join(`\n\n${'-'.repeat(80)}\n\n`);
}
