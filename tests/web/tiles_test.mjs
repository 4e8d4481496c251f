// SPDX-License-Identifier: Apache-2.0
// A served page that holds a sample of its map gets all points of the tiles near the camera.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, startBrowser, stopBrowser } from './browser.mjs';

const address = process.env.CLUXEL_SAMPLE_SERVICE.trim(), map = join(process.env.CLUXEL_PAGES, 'campus.clx');
let open;

before(async () => {
  await (await fetch(`${address}page`)).arrayBuffer();
  await startBrowser();
  open = await openPage(`${address}page`);
});
after(stopBrowser);

/** Numbers of points by tile: of the page, and as held now. */
const counts = (page) => page.evaluate(() => {
  const { model, viewer } = window.cluxelPage, held = new Map(viewer.tiles.map((tile) => [tile.number, tile.levels.at(-1)]));
  return model.values.tiles.map((tile, number) => ({ sample: tile.pointsTo.at(-1), held: held.get(number) }));
});

test('near the camera every point of the map is held, with its object', async () => {
  const { page } = open, points = JSON.parse(execFileSync(process.env.CLUXEL_PROGRAM, ['info', map, '--json'], { encoding: 'utf8' })).points;
  const before = await page.evaluate(() => window.cluxelPage.model.values);
  assert.ok(before.points < 0.2 * before.pointsInMap, `${before.points} of ${before.pointsInMap}`);
  await page.evaluate(() => {
    const { stage, viewer } = window.cluxelPage;
    stage.look(viewer.controls.target.clone().set(0, 0, 0), viewer.camera.up.clone().set(0, -0.1, 1), 20);
  });
  await page.waitForFunction(() => {
    const { viewer, model } = window.cluxelPage;
    return viewer.tiles.reduce((sum, tile) => sum + tile.levels.at(-1), 0) > 0.97 * model.values.pointsInMap;
  }, null, { timeout: 60_000 });
  for (const { sample, held } of await counts(page)) assert.ok(held >= sample);
  if (points) assert.equal(before.pointsInMap, points);
  assert.match(await page.textContent('.title'), /more points near the camera/);
  const largest = await page.evaluate(() => {
    const { model, viewer } = window.cluxelPage, of_object = new Map();
    for (const tile of viewer.tiles)
      for (const number of new Uint32Array(tile.buffer).filter((_, i) => i % 4 === 2)) of_object.set(number, (of_object.get(number) ?? 0) + 1);
    const trees = model.objects.filter((object) => object.class.label === 'tree').sort((a, b) => b.points - a.points);
    return { id: trees[0].id, points: of_object.get(trees[0].number + 1) };
  });
  const told = await (await fetch(`${address}objects/${largest.id}/points`)).json();
  assert.ok(Math.abs(largest.points - told.x.length) < 0.05 * told.x.length, `${largest.points} drawn, ${told.x.length} told`);
});

test('a tile of another state, and one without points, are refused', async () => {
  const { page } = open, [x, y] = await page.evaluate(() => window.cluxelPage.model.values.tiles[0].origin.map((value) => Math.round(value / 16)));
  assert.equal((await fetch(`${address}tiles/${x}/${y}`)).status, 200);
  const old = await fetch(`${address}tiles/${x}/${y}?state=${'0'.repeat(32)}`);
  assert.equal(old.status, 409);
  assert.match(await old.text(), /load the page again/);
  assert.equal((await fetch(`${address}tiles/99999/0`)).status, 404);
  assert.equal((await fetch(`${address}tiles/1.5/0`)).status, 400);
  assert.equal((await fetch(`${address}tiles/${x}/${y}?intensity=3`)).status, 400);
});
