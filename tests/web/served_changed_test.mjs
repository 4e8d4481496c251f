// SPDX-License-Identifier: Apache-2.0
// A served page of which the map changes meanwhile: it says so, tells no untruth of its objects, and loads anew.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { pageOfEachTest } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM, map = join(folder, 'shrinking.clx');
const page_address = `${process.env.CLUXEL_CHANGED_SERVICE.trim()}page`, token = readFileSync(join(folder, 'token'), 'utf8').trim();
const cluxel = (...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1e9, stdio: ['ignore', 'pipe', 'ignore'] });
const open = pageOfEachTest(page_address);

function idsInMap() {
  const told = JSON.parse(cluxel('query', map, '-e', 'SELECT ?o { ?o clx:confidence ?c }', '--format', 'json'));
  return new Set(told.results.bindings.map(({ o }) => o.value));
}

function successorsOf(iri) {
  const told = JSON.parse(cluxel('query', map, '-e', `SELECT (COUNT(?o) AS ?n) { GRAPH <https://w3id.org/cluxel/graph/history> { ?o prov:wasDerivedFrom <${iri}> } }`, '--format', 'json'));
  return Number(told.results.bindings[0].n.value);
}

async function lineageOf(page, iri) {
  await page.evaluate((wanted) => {
    const { store, model } = window.cluxelPage;
    store.set('selected', null);
    store.set('selected', model.objectOf(wanted));
  }, iri);
  await page.click('.lineage summary');
  await page.waitForSelector('.lineage-list > *');
  return page.textContent('.lineage-list');
}

async function askInventory(page) {
  await page.click('#tab-tasks');
  await page.click('[data-task=inventory]');
  await page.click('.tasks .primary');
  await page.waitForFunction(() => !document.querySelector('.tasks .actions').hidden, null, { timeout: 60_000 });
  return page.textContent('.tasks .status');
}

const shownIris = (page) => page.evaluate(() => window.cluxelPage.model.objects.map(({ iri }) => iri));

test('a page whose map has not changed says nothing', async () => {
  const { page } = open;
  assert.doesNotMatch(await askInventory(page), /has changed/);
  assert.equal((await lineageOf(page, (await shownIris(page))[0])).trim(), 'It was made by the build, and no change has touched it.');
  assert.equal(await page.locator('.changed > *').count(), 0);
});

async function savedStatement(page, iri) {
  await page.evaluate((wanted) => {
    const { store, model } = window.cluxelPage;
    store.set('selected', null);
    store.set('selected', model.objectOf(wanted));
  }, iri);
  await page.click('text=Wrong class, or something to say?');
  await page.fill('#remark', 'seen by the test');
  await page.click('#tab-rules');
  await page.fill('#token', token);
  await page.click('text=Save in the map');
  await page.waitForFunction(() => !/^(Choose.*)?$/.test(document.querySelector('.correction [role=status]').textContent));
  return page.textContent('.correction [role=status]');
}

test('a state that could not be read is no change, and one that changed meanwhile is', async () => {
  const { page } = open, toldAs = async (state) => {
    await page.route('**/tasks/inventory**', async (route) => {
      const response = await route.fetch();
      await route.fulfill({ response, headers: { ...response.headers(), 'cluxel-state': state } });
    });
    const told = await askInventory(page);
    await page.unroute('**/tasks/inventory**');
    return told;
  };
  assert.doesNotMatch(await toldAs('unknown'), /has changed/);
  assert.equal(await page.locator('.changed > *').count(), 0);
  assert.match(await toldAs('changed'), /has changed/);
});

test('a map that has changed is told with every answer, once above them all, and the page is loaded anew', async () => {
  const { page } = open;
  const before = await shownIris(page);
  cluxel('retract', map, 'scan_002.pcd');
  const now = idsInMap(), gone = before.filter((iri) => !now.has(iri)), kept = before.filter((iri) => now.has(iri));
  assert.ok(gone.length > 0 && kept.length > 0);
  for (const iri of gone.slice(0, 5)) {
    const told = await lineageOf(page, iri);
    assert.match(told, /no more in the map.*(It ended by |went on as .*)retract \d{4}-/);
    assert.equal((told.match(/went on as/g) ?? []).length, successorsOf(iri));
  }
  assert.match(await lineageOf(page, kept[0]), /of the map as it is now, which has changed/);
  assert.match(await askInventory(page), /rows.* · This is of the map as it is now, which has changed since this page was made\.$/);
  assert.equal(await page.locator('.changed p').count(), 1);
  assert.ok(await page.isVisible('.changed'));
  await Promise.all([page.waitForNavigation({ timeout: 120_000 }), page.click('text=Load the page anew')]);
  await page.waitForFunction(() => window.cluxelPage && document.querySelector('.reading')?.hidden, null, { timeout: 120_000 });
  assert.deepEqual((await shownIris(page)).filter((iri) => !idsInMap().has(iri)), []);
  assert.doesNotMatch(await askInventory(page), /has changed/);
  assert.equal(await page.locator('.changed > *').count(), 0);
});

test('a statement about an object that has gone says so, also where the page knows of no change yet', async () => {
  const { page } = open, before = await shownIris(page);
  cluxel('retract', map, 'scan_001.pcd');
  const now = idsInMap(), kept = before.find((iri) => now.has(iri)), gone = before.find((iri) => !now.has(iri) && successorsOf(iri) > 0);
  assert.ok(kept && gone);
  assert.equal(await page.evaluate(() => document.querySelectorAll('.changed > *').length), 0);
  assert.match(await savedStatement(page, gone), /^Saved as .* has gone since this page was made: the statement is about what it went on as\./);
  assert.match(await savedStatement(page, kept), /^Saved as an operator statement\. This page shows/);
});
