// SPDX-License-Identifier: Apache-2.0
// Answers of the service that come after a person has gone on to something else.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { afterEach, test } from 'node:test';
import { writeText } from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const page_address = `${process.env.CLUXEL_SERVICE.trim()}page`;
const token = readFileSync(join(process.env.CLUXEL_PAGES, 'token'), 'utf8').trim();
const open = pageOfAllTests(page_address, { expected: /status of 503/ });
afterEach(() => open.page.isClosed() || open.page.unrouteAll({ behavior: 'ignoreErrors' }));  // a page of one test is closed by now

/** Holds the first request to `address` back until `release` is called; then it is answered by `reply`. */
async function heldBack(page, address, reply) {
  let release;
  const held = new Promise((resolve) => { release = resolve; });
  await page.route(address, async (route) => {
    await held;
    await route.fulfill(reply);
  }, { times: 1 });
  return async () => {
    const arrived = page.waitForResponse(address);
    release();
    await (await arrived).finished();
    await page.evaluate(() => new Promise((resolve) => { setTimeout(resolve, 50); }));
  };
}

const textOf = (page, selector) => page.textContent(selector);

for (const [what, reply] of [
  ['answer', { json: { columns: [{ name: 'late', unit: '', help: '' }], rows: [{ late: 1 }], notes: [] } }],
  ['fault', { status: 503, body: 'a late fault' }],
]) {
  test(`a late ${what} of a task is dropped when the task was chosen anew`, async () => {
    const { page } = open;
    await page.click('#tab-tasks');
    await page.click('[data-task=inventory]');
    const release = await heldBack(page, /tasks\/inventory/, reply);
    await page.click('.tasks .primary');
    assert.equal(await textOf(page, '.tasks .status'), 'Asking…');
    await page.click('[data-task=route]');
    await page.click('[data-task=inventory]');
    assert.ok(await page.isEnabled('.tasks .primary'), 'the next question need not wait');
    await release();
    assert.equal(await textOf(page, '.tasks .status'), '');
    assert.equal(await page.locator('.tasks .answer tbody tr').count(), 0);
    assert.equal(await page.getAttribute('.tasks', 'aria-busy'), 'false');
  });

  test(`a late ${what} about rules is dropped when they were changed since`, async () => {
    const { page } = open;
    await page.click('#tab-rules');
    await page.fill('#token', token);
    const text = await page.inputValue('#rule-text');
    await page.route(/rules\/trial/, () => {});  // the second trial never ends
    const trial = { before: 1, after: 1, counts: {}, changes: [] };
    const release = await heldBack(page, /rules\/trial/, what === 'answer' ? { json: trial } : reply);
    await writeText(page, '#rule-text', `${text}# first\n`);
    await page.waitForFunction(() => document.querySelector('.rules').getAttribute('aria-busy') === 'true');
    await writeText(page, '#rule-text', `${text}# second\n`);
    await release();
    assert.equal(await textOf(page, '.rules .status'), 'Trying…');
    assert.equal(await page.locator('.rules .status.fault').count(), 0);
  });
}

test('a fault of the lineage stands in the card', async () => {
  const { page } = open;
  await page.route(/sparql\?format=json/, (route) => route.fulfill({ status: 503, body: 'the map is away' }), { times: 1 });
  await page.evaluate(() => {
    const { store, model } = window.cluxelPage;
    store.set('selected', model.objects[0]);
  });
  await page.click('.lineage summary');
  await page.waitForSelector('.lineage-list .fault');
  assert.match(await textOf(page, '.lineage-list .fault'), /the map is away/);
});
