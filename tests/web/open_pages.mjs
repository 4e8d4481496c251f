// SPDX-License-Identifier: Apache-2.0
// Opens a page of its own for each test of a file, and asks at its end that nothing went wrong.
import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach } from 'node:test';
import { openPage, startBrowser, stopBrowser } from './browser.mjs';

/**
 * For the tests of one file. Returns the page of the test that runs, as openPage() does, with `again(file, options)`,
 * which opens another page in its place. `address`: as for openPage(); `expected`: faults that are none.
 */
export function pageOfEachTest(address, { expected = /^$/ } = {}) {
  const open = {
    again: async (file, options) => {
      await open.close();
      Object.assign(open, await openPage(file, options));
    },
  };
  before(async () => {
    if (address.startsWith('http:')) await (await fetch(address)).arrayBuffer();  // the service makes the page for the first request
    await startBrowser();
  });
  after(stopBrowser);
  beforeEach(async () => { Object.assign(open, await openPage(address)); });
  afterEach(async () => {
    assert.deepEqual(open.faults.filter((fault) => !expected.test(fault)), [], 'nothing on the console, no error, no request to others');
    await open.close();
  });
  return open;
}
