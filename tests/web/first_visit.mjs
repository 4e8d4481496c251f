// SPDX-License-Identifier: Apache-2.0
// What a newcomer does with the demo's map: first_visit_test.sh makes the map and serves it.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { askNamed, drawn, openPage, startBrowser, stopBrowser, writeText } from './browser.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM, map = join(folder, 'campus.clx');
const cluxel = (...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1e9 });
const taskOf = (...values) => JSON.parse(cluxel('ask', map, ...values, '--json'));

before(startBrowser);
after(stopBrowser);

async function askTask(page, name, values) {
  await page.click('#tab-tasks');
  await page.click(`[data-task="${name}"]`);
  for (const [key, value] of Object.entries(values)) await page.fill(`#task-${key}`, value);
  await page.click('.tasks .primary');
  await page.waitForSelector('.tasks .actions:not([hidden])', { timeout: 60_000 });
}

test('a newcomer searches signs, asks why, changes a threshold and takes a cost map away', async () => {
  const { page, faults, close } = await openPage(`${process.env.CLUXEL_SERVICE.trim()}page`);

  // Where should I look for street signs first? The class is written as people write it.
  await askTask(page, 'search', { for: 'street sign' });
  const tour = taskOf('search', 'for=StreetSign').rows;
  assert.ok(tour.length > 2);
  assert.deepEqual(await page.$$eval('.pin-mark', (pins) => pins.map((pin) => pin.textContent)), tour.map((_, i) => String(i + 1)));
  const walks = await page.evaluate(() => window.cluxelPage.store.state.marks.flatMap(({ path }) => path?.length ? [path] : []));
  assert.deepEqual(walks, tour.flatMap(({ way }) => (way ? [way] : [])));
  walks.slice(1).forEach((walk, i) => assert.deepEqual(walk[0], walks[i].at(-1), 'one walk goes on from the other'));
  await drawn(page);
  assert.ok(await page.locator('.pin-mark:visible').count() > 0);

  // Why is this one a sign?
  await page.click('#tab-questions');
  await askNamed(page, 'street_signs.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.waitForSelector('.why .step');
  const id = await page.evaluate(() => window.cluxelPage.store.state.selected.id);
  assert.equal(await page.textContent('.why summary'), 'Why Street sign?');
  const accepted = JSON.parse(cluxel('explain', map, id, '--json')).decisions.find((decision) => decision.accepted);
  const told = await page.$$eval('.why .step', (steps) => steps.map((step) => step.textContent));
  assert.equal(told.length, accepted.path.length);
  const measured = accepted.path.findIndex((step) => step.measured !== undefined);
  assert.ok(told[measured].includes(`measured ${Number(accepted.path[measured].measured.toFixed(3))}`), told[measured]);

  // What would change if a bush were at most 1.2 m high?
  await page.click('#tab-rules');
  const rules = await page.inputValue('#rule-text'), changed = rules.replace('bush_top: 1.7 m', 'bush_top: 1.2 m');
  assert.notEqual(changed, rules);
  await page.fill('#token', readFileSync(join(folder, 'token'), 'utf8').trim());
  await writeText(page, '#rule-text', changed);
  await page.waitForFunction(() => /^\d+ objects change/.test(document.querySelector('.rules .status').textContent), null, { timeout: 120_000 });
  const count = Number((await page.textContent('.rules .status')).match(/^\d+/)[0]);
  assert.ok(count > 0);
  assert.ok(await page.evaluate(() => window.cluxelPage.store.state.tints.size) > 0, 'what changes is coloured');

  // A cost map without cars.
  await askTask(page, 'costmap', { without: 'vehicle' });
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('.tasks .actions >> text=GeoJSON')]);
  const closed = (text) => JSON.parse(text).features.find(({ properties }) => properties.kind === 'thing').properties.area;
  const taken = readFileSync(await download.path(), 'utf8');
  assert.equal(taken, cluxel('ask', map, 'costmap', 'without=Vehicle', '--geojson', '--local'));
  assert.ok(closed(taken) < closed(cluxel('ask', map, 'costmap', '--geojson', '--local')), 'vehicles closed some ground');
  assert.deepEqual(faults, [], 'nothing on the console, no error, no request to others');
  await close();
});
