// SPDX-License-Identifier: Apache-2.0
// Makes dist/page.html: the page without a map. Programs, styles and the SPARQL engine are in it; the policy in its head
// allows exactly these and no request to anywhere. `cluxel view` puts a map's data at the mark "map data".
import { build } from 'esbuild';
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { engineBytes } from './engine.mjs';
import { licenceText } from './licences.mjs';

const folder = dirname(fileURLToPath(import.meta.url));
const inFolder = (...parts) => join(folder, ...parts);

async function bundled(entry, options = {}) {
  const result = await build({
    entryPoints: [inFolder(entry)],
    bundle: true,
    minify: true,
    write: false,
    target: ['chrome109', 'firefox113', 'safari16.4'],
    format: 'iife',
    legalComments: 'none',
    charset: 'utf8',
    define: { 'import.meta.url': '""' },
    loader: { '.svg': 'dataurl' },
    absWorkingDir: folder,
    logLevel: 'warning',
    ...options,
  });
  return result.outputFiles[0].text;
}

/** Text between script or style tags: "</" would end the element. */
function inElement(text) {
  return text.replaceAll('</script', '<\\/script').replaceAll('</style', '<\\/style').replaceAll('<!--', '<\\!--').trim();
}

const hashOf = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const packed = (bytes) => gzipSync(bytes, { level: 9 }).toString('base64');
const block = (id, bytes) => `<script type="application/gzip+base64" id="${id}">${packed(bytes)}</script>`;

const program = inElement(await bundled('src/main.ts'));
const worker = await bundled('src/sparql/worker.ts');
const style = inElement(
  readFileSync(inFolder('node_modules/@zazuko/yasqe/build/yasqe.min.css'), 'utf8') +
    (await bundled('src/style.css', { format: undefined })),
);
const policy = [
  "default-src 'none'",
  `script-src ${hashOf(program)} 'wasm-unsafe-eval'`,
  `style-src ${hashOf(style)}`,
  "style-src-attr 'unsafe-inline'",
  'img-src data: blob:',
  'worker-src blob:',
  "base-uri 'none'",
  "form-action 'none'",
].join('; ');

const page = readFileSync(inFolder('src/page.html'), 'utf8')
  .replace('{{policy}}', () => policy)
  .replace('{{style}}', () => style)
  .replace('{{engine}}', () => block('engine', engineBytes(folder)))
  .replace('{{worker}}', () => block('worker', Buffer.from(worker)))
  .replace('{{licences}}', () => block('licences', Buffer.from(licenceText(folder))))
  .replace('{{program}}', () => program);
mkdirSync(inFolder('dist'), { recursive: true });
writeFileSync(inFolder('dist/page.html'), page);
console.log(`web/dist/page.html: ${(page.length / 1e6).toFixed(2)} MB`);
