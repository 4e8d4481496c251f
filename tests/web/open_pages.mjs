// SPDX-License-Identifier: Apache-2.0
// Opens the page of the tests of a file, one for each or one for all, and asks after each that nothing went wrong.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach } from 'node:test';
import { openPage, settled, startBrowser, stopBrowser } from './browser.mjs';

async function begin(address) {
  if (address.startsWith('http:')) await (await fetch(address)).arrayBuffer();  // the service makes the page for the first request
  await startBrowser();
}

/** Long tests open a page for each test. */
const isLong = process.env.CLUXEL_LONG_TESTS !== undefined;

const checkFaults = (open, expected) =>
  assert.deepEqual(open.faults.filter((fault) => !expected.test(fault)), [], 'nothing on the console, no error, no request to others');

/**
 * A new page for each test of a file, for what leaves something behind. Returns the page of the test that runs, as
 * openPage() does, with `again(file, options)`, which opens another page in its place. `address`: as for openPage();
 * `expected`: faults that are none.
 */
export function pageOfEachTest(address, { expected = /^$/ } = {}) {
  const open = {
    again: async (file = address, options = {}) => {
      await open.close();
      Object.assign(open, await openPage(file, options));
    },
  };
  before(() => begin(address));
  after(stopBrowser);
  beforeEach(async () => { Object.assign(open, await openPage(address)); });
  afterEach(async () => {
    checkFaults(open, expected);
    await open.close();
  });
  return open;
}

/**
 * One page for all tests of a file, put back before each: to open one takes seconds of both cores. For tests that look
 * and ask. What the page has read stays read: its engine, places, reasons and changes of visits. A test that damages
 * these, must see them read for the first time, or hides kinds of places, needs `again()`, whose page is that test's
 * alone. `./run test --long` opens a page for each test, and so shows tests that pass only after others.
 */
export function pageOfAllTests(address, { expected = /^$/ } = {}) {
  if (isLong) return pageOfEachTest(address, { expected });
  let shared, opened;
  const open = {
    again: async (file = address, options = {}) => {
      if (open.page !== shared.page) await open.close();
      Object.assign(open, await openPage(file, options));
    },
  };
  before(async () => {
    await begin(address);
    shared = await openPage(address);
    await shared.page.evaluate(() => {
      const { store, viewer } = window.cluxelPage;
      window.asOpened = {
        state: { ...store.state }, view: viewer.camera.matrixWorld.toArray().join(), details: new Map([...document.querySelectorAll('details')].map((one) => [one, one.open])),
        question: document.querySelector('#question').value, text: document.querySelector('.CodeMirror').CodeMirror.getValue(),
      };
    });
    opened = await shown(shared.page);
  });
  after(stopBrowser);
  beforeEach(async () => {
    Object.assign(open, shared);
    await putBack(shared.page);
    const now = await shown(shared.page), different = Object.keys({ ...opened, ...now }).filter((name) => now[name] !== opened[name]);
    assert.deepEqual(different.map((name) => `${name}: ${now[name]}`), [], 'the page is as it opened');
  });
  afterEach(async () => {
    const isShared = open.page === shared.page, before_again = isShared ? [] : shared.faults;
    if (!isShared) await open.close();
    const faults = [...open.faults, ...before_again];
    shared.faults.length = 0;
    checkFaults({ faults }, expected);
  });
  return open;
}

/**
 * What a page shows and what is set on it, as texts by name: its whole state, its fields, and what lies open. Cards are
 * left out: they are made anew for each thing that is selected.
 */
const shown = (page) => page.evaluate(() => {
  const { store, viewer } = window.cluxelPage;
  const text = (value) => JSON.stringify(value, (_, one) => one?.iri ?? (one instanceof Set || one instanceof Map ? [...one] : one));
  const each = (kind, selector, valueOf) => [...document.querySelectorAll(selector)].filter((one) => !one.closest('.card')).map((one) => [`${kind} ${one.id}`, String(valueOf(one))]);
  const count = (what, selector) => [what, String([...document.querySelectorAll(selector)].filter((one) => !one.closest('.card')).length)];
  const address = new URLSearchParams(location.hash.slice(1));
  address.delete('camera');  // it is written when the camera rests
  return Object.fromEntries([
    ...Object.entries(store.state).map(([key, value]) => [`state ${key}`, text(value)]),
    ...each('field', 'input[id], select[id], textarea[id]', (one) => (['checkbox', 'radio'].includes(one.type) ? one.checked : one.value)),
    ...each('tab', '[role=tab]', (one) => one.getAttribute('aria-selected')),
    ['question', document.querySelector('.CodeMirror').CodeMirror.getValue()], ['answer', document.querySelector('.ask .status').textContent],
    count('hidden kinds', '.legend input[type=checkbox]:not(:checked)'), count('rows', '.answer tbody tr, .trial li'), count('faults', '.fault'),
    count('open boxes', 'details[open], dialog[open]'), ['address', address.toString()],
    ['camera', viewer.camera.matrixWorld.toArray().map((value) => value.toFixed(6)).join()],
  ]);
});

/** Takes a page back to how it opened: what is shown, asked and typed, the camera and the address. */
async function putBack(page) {
  await page.mouse.move(0, 0);
  await page.evaluate(() => {
    const { store } = window.cluxelPage, { state, details, question, text } = window.asOpened;
    document.querySelector('dialog[open]')?.close();
    document.activeElement?.blur();
    const buttons = [...document.querySelectorAll('.panel button, .ask button')], press = (text) => buttons.find((one) => one.textContent === text && !one.disabled)?.click();
    press('Undo all');
    document.querySelector('#look-kind')?.click();
    for (const field of document.querySelectorAll('.legend input[type=range], #token')) {
      if (field.value === field.defaultValue) continue;
      field.value = field.defaultValue;
      field.dispatchEvent(new Event('input'));
    }
    document.querySelector('[data-task]')?.click();  // choosing a task empties its form
    buttons.filter((one) => one.textContent === 'Clear').forEach((one) => one.click());
    const status = document.querySelector('.ask .status');  // that of a fault has no button
    status.textContent = '';
    status.classList.remove('fault');
    document.querySelector('.ask .parameters').replaceChildren();  // the first question has none
    document.querySelector('#question').value = question;
    document.querySelector('.CodeMirror').CodeMirror.setValue(text);
    for (const [key, value] of Object.entries(state)) store.set(key, value);
    document.querySelector('#tab-questions').click();
    for (const [one, isOpen] of details) one.open = isOpen;
  });
  await settled(page);  // a card that closes makes the view wider
  await page.evaluate(() => {
    const { stage, viewer } = window.cluxelPage;
    if (viewer.camera.matrixWorld.toArray().join() !== window.asOpened.view) stage.home();  // which draws all points anew
    history.replaceState(null, '', '#');
  });
  await settled(page);
}
