// SPDX-License-Identifier: Apache-2.0
// Opens the page of the tests of a file, one for each or one for all, and asks after each that nothing went wrong.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach } from 'node:test';
import { openPage, settled, startBrowser, stopBrowser } from './browser.mjs';

async function begin(address) {
  if (address.startsWith('http:')) await (await fetch(address)).arrayBuffer();  // the service makes the page for the first request
  await startBrowser();
}

const checkFaults = (open, expected) =>
  assert.deepEqual(open.faults.filter((fault) => !expected.test(fault)), [], 'nothing on the console, no error, no request to others');

/**
 * A new page for each test of a file, for what leaves something behind. Returns the page of the test that runs, as
 * openPage() does, with `again(file, options)`, which opens another page in its place. `address`: as for openPage();
 * `expected`: faults that are none.
 */
export function pageOfEachTest(address, { expected = /^$/ } = {}) {
  const open = {
    again: async (file, options) => {
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
 * and ask; what cannot be put back, as hidden kinds of places, needs `again()`, whose page is that test's alone.
 */
export function pageOfAllTests(address, { expected = /^$/ } = {}) {
  let shared;
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
      window.asOpened = { state: { ...store.state }, view: viewer.camera.matrixWorld.toArray().join(), details: new Map([...document.querySelectorAll('details')].map((one) => [one, one.open])) };
    });
  });
  after(stopBrowser);
  beforeEach(async () => {
    Object.assign(open, shared);
    await putBack(shared.page);
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

/** Takes a page back to how it opened: what is shown, asked and typed, the camera and the address. */
async function putBack(page) {
  await page.mouse.move(0, 0);
  const different = await page.evaluate(() => {
    const { store, stage, viewer } = window.cluxelPage, { state, view, details } = window.asOpened;
    document.querySelector('dialog[open]')?.close();
    document.activeElement?.blur();
    const buttons = [...document.querySelectorAll('.panel button')], press = (text) => buttons.find((one) => one.textContent === text && !one.disabled)?.click();
    press('Undo all');
    for (const field of document.querySelectorAll('.legend input[type=range], #token')) {
      if (field.value === field.defaultValue) continue;
      field.value = field.defaultValue;
      field.dispatchEvent(new Event('input'));
    }
    document.querySelector('[data-task]')?.click();  // choosing a task empties its form
    buttons.filter((one) => one.textContent === 'Clear').forEach((one) => one.click());
    for (const [key, value] of Object.entries(state)) store.set(key, value);
    document.querySelector('#tab-questions').click();
    for (const [one, isOpen] of details) one.open = isOpen;
    if (viewer.camera.matrixWorld.toArray().join() !== view) stage.home();  // which draws all points anew
    history.replaceState(null, '', '#');
    return Object.keys(state).filter((key) => store.state[key] !== state[key]);
  });
  assert.deepEqual(different, [], 'the page is as it opened');
  await settled(page);
}
