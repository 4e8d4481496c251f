// SPDX-License-Identifier: Apache-2.0
// A page in Debian's headless Chromium, with software rendering, and a record of what must not happen: messages on the
// console, errors, requests.
import { createRequire } from 'node:module';
import { join } from 'node:path';

const source = process.env.CLUXEL_SOURCE;
const { chromium } = createRequire(join(source, 'web', 'package.json'))('playwright-core');
const FLAGS = ['--headless=new', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

let browser;

export async function startBrowser() {
  browser = await chromium.launch({ executablePath: process.env.CLUXEL_CHROMIUM, args: FLAGS });
}

export async function stopBrowser() {
  await browser?.close();
}

/**
 * Opens a file as `file://…#hash`, or a page of the service at the address `file`, and waits until all points are drawn.
 * A file may ask nobody, a page its service.
 */
export async function openPage(file, { hash = '', width = 1200, height = 800, dark = false } = {}) {
  const isServed = file.startsWith('http:'), own = isServed ? new URL(file).origin : 'file:';
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: dark ? 'dark' : 'light', offline: !isServed });
  const page = await context.newPage(), faults = [];
  page.on('console', (message) => faults.push(`console ${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => faults.push(`error: ${error.message}`));
  page.on('request', (request) => {
    if (!/^(blob|data):/.test(request.url()) && !request.url().startsWith(own)) faults.push(`request: ${request.url()}`);
  });
  await page.goto(`${isServed ? file : `file://${file}`}${hash}`, { timeout: 120_000 });
  await page.waitForFunction(() => window.cluxelPage && document.querySelector('.reading')?.hidden, null, { timeout: 120_000 });
  await drawn(page);
  return { page, faults, close: () => context.close() };
}

export async function drawn(page) {
  await page.waitForFunction(() => window.cluxelPage.viewer.isComplete, null, { timeout: 120_000 });
}

/** Waits until the view has taken a new size and is drawn. */
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await drawn(page);
}

/** Asks a shipped question and waits for its rows. */
export async function askNamed(page, file) {
  await page.selectOption('#question', file);
  await answered(page);
}

export async function answered(page) {
  await page.waitForFunction(() => document.querySelector('.ask').getAttribute('aria-busy') === 'false', null, { timeout: 60_000 });
}

/** The text that the editor holds. */
export const editorText = (page) => page.evaluate(() => document.querySelector('.CodeMirror').CodeMirror.getValue());

/** Writes a question of one's own and asks it. */
export async function ask(page, text) {
  await page.evaluate((value) => document.querySelector('.CodeMirror').CodeMirror.setValue(value), text);
  await page.click('.ask .primary');
  await answered(page);
}

/** Puts a long text into a field as if it were typed. `page.fill` takes seconds for a text of the length of a rule file. */
export const writeText = (page, field, text) => page.$eval(field, (area, value) => {
  area.focus();
  area.value = value;
  area.dispatchEvent(new Event('input', { bubbles: true }));
}, text);

/**
 * A place on the page, in CSS pixels, where a point of the object is seen and no other object's point lies before it or
 * around it: found by projecting all points, without the page's own picking.
 */
export function placeOf(page, id) {
  return page.evaluate((digits) => {
    const { model, viewer } = window.cluxelPage, wanted = model.objectStartingWith(digits).number + 1;
    const canvas = viewer.renderer.domElement.getBoundingClientRect(), points = [], own = [];
    for (const tile of viewer.tiles) {
      const shorts = new Uint16Array(tile.buffer), words = new Uint32Array(tile.buffer), at = viewer.camera.position.clone();
      for (let i = 0; i < words.length / 4; ++i) {
        at.set(shorts[8 * i], shorts[8 * i + 1], shorts[8 * i + 2]).applyMatrix4(tile.points.matrixWorld).project(viewer.camera);
        const seen = { x: (0.5 + 0.5 * at.x) * canvas.width, y: (0.5 - 0.5 * at.y) * canvas.height, z: at.z };
        const isSeen = at.z < 1 && seen.x > 260 && seen.x < canvas.width - 20 && seen.y > 80 && seen.y < canvas.height - 40;
        if (words[4 * i + 2] !== wanted) points.push(seen);
        else if (isSeen) own.push(seen);
      }
    }
    const reach = 14;
    const free = own.slice(0, 400).find((point) =>
      points.every((other) => Math.abs(other.x - point.x) > reach || Math.abs(other.y - point.y) > reach || other.z > point.z));
    return free && { x: canvas.left + free.x, y: canvas.top + free.y };
  }, id);
}

/** The texels of objects: "hidden", "dimmed", "plain" or "lit" by number. */
export function states(page) {
  return page.evaluate(() => {
    const { model, viewer } = window.cluxelPage, data = viewer.palette.texture.image.data;
    const names = { 0: 'hidden', 85: 'dimmed', 170: 'plain', 255: 'lit' };
    return model.objects.map((object) => names[data[4 * (object.number + 1) + 3]]);
  });
}

/** How many pixels of the view are not background. */
export const coveredPixels = (page) => page.evaluate(() => {
  const { renderer, picture } = window.cluxelPage.viewer;
  const pixels = new Uint8Array(4 * picture.width * picture.height);
  renderer.setRenderTarget(picture);
  renderer.readRenderTargetPixels(picture, 0, 0, picture.width, picture.height, pixels);
  renderer.setRenderTarget(null);
  let covered = 0;
  for (let i = 0; i < pixels.length; i += 4) covered += pixels[i] + pixels[i + 1] + pixels[i + 2] > 0 ? 1 : 0;
  return covered;
});

/** A colour as CIE Lab, as an eye without green cones sees it (Machado, Oliveira and Fernandes 2009). */
export function seenWithoutGreenCones(rgb) {
  const [r, g, b] = rgb.map((value) => (value <= 10.31475 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4));
  const R = 0.367322 * r + 0.860646 * g - 0.227968 * b, G = 0.280085 * r + 0.672501 * g + 0.047413 * b;
  const B = -0.01182 * r + 0.04294 * g + 0.968881 * b;
  const f = (t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116);
  const x = f((0.4124 * R + 0.3576 * G + 0.1805 * B) / 0.9505), y = f(0.2126 * R + 0.7152 * G + 0.0722 * B);
  const z = f((0.0193 * R + 0.1192 * G + 0.9505 * B) / 1.089);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}
