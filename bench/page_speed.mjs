// SPDX-License-Identifier: Apache-2.0
// How fast a page is in headless Chromium with software rendering: page_speed.mjs PAGE.html. Prints JSON: time to the
// first picture and to all points, frames while the camera turns, from a change of the answer to the lit picture, and from a
// click (its button is down for 80 ms) to the picture in which the object is selected.
import { createRequire } from 'node:module';
import { statSync } from 'node:fs';

const { chromium } = createRequire(new URL('../web/package.json', import.meta.url))('playwright-core');
const file = process.argv[2];
const browser = await chromium.launch({
  executablePath: process.env.CLUXEL_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--headless=new', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
await page.goto(`file://${file}`, { timeout: 120_000 });
await page.waitForFunction(() => window.cluxelPage?.viewer.isComplete && document.querySelector('.reading')?.hidden, null, { timeout: 300_000 });
const complete = await page.evaluate(() => performance.now());

/** The camera turns; frames that show something new are timed. The first three seconds, in which the budget adapts, are left out. */
const frames = await page.evaluate(() => new Promise((done) => {
  const { viewer, stage } = window.cluxelPage, { camera, controls } = viewer, times = [], start = performance.now();
  let last = start;
  const shown = () => {
    const now = performance.now();
    if (now - start > 3000) times.push(now - last);
    last = now;
  };
  viewer.onFrame.push(shown);
  const step = (now) => {
    if (now - start > 15_000) {
      viewer.onFrame.pop();
      return done(times);
    }
    const direction = camera.position.clone().sub(controls.target), distance = direction.length(), turn = Math.PI / 180;
    const { x, y } = direction;
    direction.set(x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn), direction.z);
    stage.look(controls.target.clone(), direction, distance);
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}));
await page.waitForFunction(() => window.cluxelPage.viewer.isComplete, null, { timeout: 300_000 });

/** Lights up one object after the other; a picture counts when the graphics have finished it. */
const lit = await page.evaluate(async () => {
  const { viewer, store, model } = window.cluxelPage, gl = viewer.renderer.getContext(), times = [];
  for (let i = 0; i < 40; ++i) {
    const start = performance.now();
    const shown = new Promise((done) => viewer.onFrame.push(done));
    store.set('lit', { objects: [model.objects[(i * 37) % model.objects.length]], ranked: false });
    await shown;
    viewer.onFrame.pop();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    times.push(performance.now() - start);
    await new Promise((done) => setTimeout(done, 150));
  }
  return times;
});
/** Clicks on places over the view; each other object that is hit counts. */
const clicks = await page.evaluate(async () => {
  const { viewer, store } = window.cluxelPage, canvas = viewer.renderer.domElement, gl = viewer.renderer.getContext(), times = [];
  const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
  for (let i = 0; i < 120 && times.length < 40; ++i) {
    const at = canvas.getBoundingClientRect(), chosen = store.state.selected;
    const send = (type) => canvas.dispatchEvent(new PointerEvent(type, {
      clientX: at.left + at.width * (0.3 + 0.65 * ((i * 0.618) % 1)), clientY: at.top + at.height * (0.15 + 0.8 * ((i * 0.382) % 1)),
      button: 0, bubbles: true, pointerId: 1,
    }));
    send('pointerdown');
    await pause(80);
    const start = performance.now();
    let shown;
    const frame = new Promise((done) => { shown = done; });
    viewer.onFrame.push(shown);
    send('pointerup');
    if (store.state.selected && store.state.selected !== chosen) {
      await frame;
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      times.push(performance.now() - start);
    }
    viewer.onFrame.splice(viewer.onFrame.indexOf(shown), 1);
    await pause(300);
  }
  return times;
});
const quantile = (values, share) => Math.round(values.sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))]);
const { points, objects, first, budget } = await page.evaluate(() => ({
  points: window.cluxelPage.model.values.points, objects: window.cluxelPage.model.objects.length,
  first: window.cluxelPage.viewer.firstPicture, budget: window.cluxelPage.viewer.detail.pointsInFrame,
}));
console.log(JSON.stringify({
  megabytes: statSync(file).size / 1e6, points, objects, first_picture_ms: Math.round(first), all_points_ms: Math.round(complete),
  frame_median_ms: quantile(frames, 0.5), frame_p95_ms: quantile(frames, 0.95), points_a_frame: Math.round(budget),
  lit_median_ms: quantile(lit, 0.5), lit_p95_ms: quantile(lit, 0.95),
  clicks: clicks.length, click_median_ms: quantile(clicks, 0.5), click_p95_ms: quantile(clicks, 0.95),
}, null, 1));
await browser.close();
