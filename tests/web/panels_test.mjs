// SPDX-License-Identifier: Apache-2.0
// Visits, tasks, rules and "why not" of a file that has no service: what it answers by itself, and what it says otherwise.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { askNamed, openPage, settled, states, writeText } from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM;
const map = join(folder, 'visits.clx'), html = join(folder, 'visits.html');
const cluxel = (...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1e9 });
const changes = JSON.parse(cluxel('changes', map, '--json'));
const open = pageOfAllTests(html);

const state = (page, name) => page.evaluate((key) => {
  const value = window.cluxelPage.store.state[key];
  return value instanceof Map ? [...value] : value;
}, name);

async function toVisit(page, number) {
  await page.$eval('#visit', (slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event('input'));
  }, String(number));
  if (number > 0) await page.waitForSelector('.visit-kinds');
}

test('the slider over visits shows what cluxel changes finds', async () => {
  const { page } = open;
  await page.click('#tab-visits');
  assert.equal(await state(page, 'tints'), null);
  await toVisit(page, 1);
  assert.ok(changes.changes.length > 0);
  const count = (kind) => page.textContent(`.visit-kinds [data-kind="${kind}"] b`).then(Number);
  for (const kind of ['appeared', 'vanished', 'moved'])
    assert.equal(await count(kind), changes.changes.filter((change) => change.change === kind).length, kind);
  const unseen = changes.states.filter((one) => one.before === 'present' && one.after === 'not observed');
  assert.equal(await count('unobserved'), unseen.length);
  assert.equal(await page.locator('ol.change-list li').count(), changes.changes.length);
  assert.equal(await page.locator('.pin-mark').count(), changes.changes.length);
  const whole = changes.changes.flatMap((change) => [change, change.now]).filter((thing) => thing && thing.number !== null && !thing.part);
  const wanted = new Set([...whole, ...unseen].map((thing) => thing.number));
  const lit = (await states(page)).flatMap((now, number) => (now === 'lit' ? [number] : []));
  assert.deepEqual(new Set(lit), wanted);
});

test('a change in the list is gone to, and the first visit clears all', async () => {
  const { page } = open;
  await page.click('#tab-visits');
  await toVisit(page, 1);
  const first = changes.changes.findIndex((change) => change.number !== null);
  await page.click(`ol.change-list li:nth-child(${first + 1}) button`);
  assert.equal(await page.evaluate(() => window.cluxelPage.store.state.selected.number), changes.changes[first].number);
  await toVisit(page, 0);
  assert.equal(await state(page, 'tints'), null);
  assert.equal(await page.locator('.pin-mark').count(), 0);
  assert.equal(await page.locator('.change-list').count(), 0);
});

test('the points of one visit are shown alone', async () => {
  const { page } = open;
  await page.click('#tab-visits');
  await toVisit(page, 1);
  await page.check('#visit-points');
  const visits = await page.evaluate(() => window.cluxelPage.model.values.visits.map((visit) => visit.scans));
  const from = visits[0], to = visits[0] + visits[1] - 1;
  assert.deepEqual(await state(page, 'scans'), [from, to]);
  const legend = () => page.evaluate(() => [document.querySelector('#first-scan').closest('fieldset').querySelector('output').textContent,
                                            document.querySelector('#first-scan').value, document.querySelector('#last-scan').value]);
  const last = visits.reduce((sum, scans) => sum + scans, 0) - 1;
  assert.deepEqual(await legend(), [`${from + 1} to ${to + 1} of ${last + 1}`, String(from), String(to)]);
  await toVisit(page, 0);
  assert.equal(await state(page, 'scans'), null);
  assert.deepEqual(await legend(), ['all', '0', String(last)]);
});

test('the card of a thing that is gone says so', async () => {
  const { page } = open;
  const gone = cluxel('query', map, '-e', 'SELECT ?o ?t { ?o clx:seenThrough ?t } ORDER BY ?o LIMIT 1', '--format', 'csv');
  const [iri, time] = gone.trim().split(/\r?\n/)[1].split(',');
  await page.evaluate((name) => {
    const { model, store } = window.cluxelPage;
    store.set('selected', model.objects.find((object) => object.iri === name));
  }, iri);
  await page.waitForSelector('[data-gone]:visible');
  assert.ok((await page.textContent('[data-gone]')).startsWith(`Gone: a scan at ${time.slice(0, 19)}`));
});

test('a fault takes the colours of the visit before away', async () => {
  await open.again();  // its changes stay damaged
  const { page } = open;
  await page.click('#tab-visits');
  await toVisit(page, 1);
  assert.notEqual(await state(page, 'tints'), null);
  await page.evaluate(() => {
    const { model } = window.cluxelPage;
    model.visitChanges = Promise.reject(new Error('the changes are damaged'));
    model.visitChanges.catch(() => {});
    document.querySelector('#visit').dispatchEvent(new Event('input'));
  });
  await page.waitForSelector('.visits .fault');
  assert.match(await page.textContent('.visits .fault'), /the changes are damaged/);
  assert.equal(await state(page, 'tints'), null);
  assert.deepEqual(await state(page, 'marks'), []);
  assert.equal(await page.inputValue('#visit'), '1', 'the fault is that of the visit that the slider names');
});

test('a map without times is told from a map of one visit', async () => {
  for (const [file, visits, hint] of [['timeless', 0, /^No scan of the map has a time and a pose.*Give times/], ['campus', 1, /^The map has one visit/]]) {
    const one = await openPage(join(folder, `${file}.html`));
    try {
      assert.equal(await one.page.evaluate(() => window.cluxelPage.model.values.visits.length), visits);
      await one.page.click('#tab-visits');
      assert.match(await one.page.textContent('.visits .count'), hint);
      assert.ok(await one.page.isDisabled('#visit'));
    } finally {
      await one.close();
    }
  }
});

test('an answer takes the place of the colours of a visit', async () => {
  const { page } = open;
  await page.click('#tab-visits');
  await toVisit(page, 1);
  await page.click('#tab-questions');
  await askNamed(page, 'trees.rq');
  assert.equal(await state(page, 'tints'), null);
  assert.equal(await page.inputValue('#visit'), '0');
  const trees = await page.evaluate(() => window.cluxelPage.model.objectsOfClass('https://w3id.org/cluxel/ontology#Tree').length);
  assert.equal((await states(page)).filter((now) => now === 'lit').length, trees);
});

test('without a service a task tells its command, which answers', async () => {
  const { page } = open;
  await page.click('#tab-tasks');
  const names = await page.$$eval('[data-task]', (buttons) => buttons.map((button) => button.dataset.task));
  const wanted = JSON.parse(cluxel('tasks', '--json')).filter((task) => !task.file).map((task) => task.name);
  assert.deepEqual(names, wanted);
  await page.click('[data-task=search]');
  assert.match(await page.textContent('.tasks .status'), /cluxel serve/);
  await page.click('.tasks .primary');
  assert.match(await page.textContent('.tasks .status.fault'), /^for: /, 'what is required is named');
  await page.fill('#task-for', 'StreetSign');
  await page.fill('#task-stops', '2');
  await page.click('.tasks .primary');
  const command = await page.textContent('.tasks code');
  assert.equal(command, 'cluxel ask MAP search for=StreetSign stops=2');
  assert.match(cluxel(...command.split(' ').slice(1).map((word) => (word === 'MAP' ? map : word))), /stop/);
});

test('without a service rules are shown and may be saved, and the page says so', async () => {
  const { page } = open;
  await page.click('#tab-rules');
  assert.match(await page.textContent('.rules .status'), /no service/);
  const text = await page.inputValue('#rule-text');
  assert.equal(text, readFileSync(join(process.env.CLUXEL_SOURCE, 'rules', 'outdoor.rules.yaml'), 'utf8'));
  await writeText(page, '#rule-text', `${text}# changed\n`);
  await page.waitForTimeout(900);
  assert.ok(await page.isEnabled('.rules .row button'));
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('text=Save as a file')]);
  assert.match(cluxel('rules', 'check', await download.path()), /./, 'the saved file is a rule file');
});

test('a tested line of the reasons opens the rule file there', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.waitForSelector('.why button.place');
  const [file, line] = (await page.textContent('.why button.place')).split(':');
  await page.click('.why button.place');
  assert.ok(await page.isVisible('#rule-text'));
  const marked = await page.$eval('#rule-text', (area) => area.value.slice(area.selectionStart, area.selectionEnd));
  const text = await page.evaluate((name) => window.cluxelPage.model.values.rules.find((rule) => name.endsWith(rule.name)).text, file);
  assert.equal(marked, text.split('\n')[Number(line) - 1]);
});

test('the card tells why an object is not of another class, or how to ask', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.waitForSelector('#why-not');
  const id = await page.evaluate(() => window.cluxelPage.store.state.selected.id);
  const rejected = JSON.parse(cluxel('explain', map, id, '--json')).decisions.filter((one) => !one.accepted).map((one) => one.class.replace('clx:', ''));
  for (const name of await page.$$eval('#why-not option', (options) => options.map((option) => option.value).filter(Boolean))) {
    await page.selectOption('#why-not', name);
    await page.waitForFunction(() => document.querySelector('.why-not-answer').childElementCount > 0);
    const told = rejected.filter((one) => one === name).length;
    assert.equal(await page.locator('.why-not-answer .why-not').count(), told, name);
    if (told === 0) assert.ok((await page.textContent('.why-not-answer code')).endsWith(`--why-not ${name}`));
  }
});

test('a statement about the class is accepted by cluxel update', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.click('text=Wrong class, or something to say?');
  await page.selectOption('#right-class', 'https://w3id.org/cluxel/ontology#StreetLamp');
  await page.fill('#remark', 'a "lamp" \\ <b>');
  const statement = await page.textContent('.correction .statement');
  const tried = join(folder, 'stated.clx');
  execFileSync('cp', [map, tried]);
  cluxel('update', tried, '-e', statement);
  const told = cluxel('query', tried, '-e', 'SELECT ?label { ?object a clx:StreetLamp ; clx:rule "operator" ; rdfs:label ?label }', '--format', 'json');
  assert.deepEqual(JSON.parse(told).results.bindings.map((row) => row.label.value), ['a "lamp" \\ <b>']);
});

test('coverage counts the scans in the column of each point', async () => {
  const { page } = open;
  await page.selectOption('#colour-mode', 'coverage');
  await settled(page);
  const wrong = await page.evaluate(() => {
    const { model, viewer } = window.cluxelPage, { quantum } = model.values;
    let faults = 0, most = 0;
    for (const tile of viewer.tiles.slice(0, 4)) {
      const points = tile.levels.at(-1), shorts = new Uint16Array(tile.buffer), bytes = new Uint8Array(tile.buffer);
      const column = (i) => [0, 1].map((axis) => Math.floor((shorts[8 * i + axis] * quantum) / 0.5)).join();
      const scans_of = new Map();
      for (let i = 0; i < points; ++i) scans_of.set(column(i), (scans_of.get(column(i)) ?? new Set()).add(shorts[8 * i + 3]));
      for (let i = 0; i < points; ++i) {
        const scans = scans_of.get(column(i));
        faults += scans.size === bytes[16 * i + 15] ? 0 : 1;
        most = Math.max(most, scans.size);
      }
    }
    return { faults, most };
  });
  assert.equal(wrong.faults, 0);
  assert.ok(wrong.most > 1);
});

test('tabs are walked through by arrow keys and have names', async () => {
  const { page } = open;
  await page.focus('#tab-questions');
  for (const id of ['tasks', 'visits', 'rules', 'questions']) {
    await page.keyboard.press('ArrowRight');
    assert.equal(await page.evaluate(() => document.activeElement.id), `tab-${id}`);
    assert.ok(await page.isVisible(`#panel-${id}`));
    assert.equal(await page.locator('[role=tabpanel]:not([hidden])').count(), 1);
  }
  const nameless = await page.evaluate(() => [...document.querySelectorAll('.panel button, .panel input, .panel select, .panel textarea')]
    .filter((control) => !(control.getAttribute('aria-label') || control.textContent.trim() || control.labels?.[0]?.textContent.trim()))
    .map((control) => control.outerHTML));
  assert.deepEqual(nameless, []);
});

test('a narrow screen holds every panel', async () => {
  await open.again(html, { width: 390, height: 780 });
  for (const id of ['tasks', 'visits', 'rules', 'questions']) {
    await open.page.click(`#tab-${id}`);
    if (id === 'visits') await toVisit(open.page, 1);
    const { wide, tall } = await open.page.evaluate(() => ({ wide: document.documentElement.scrollWidth, tall: document.documentElement.scrollHeight }));
    assert.ok(wide <= 390 && tall <= 780, `${id}: ${wide} x ${tall}`);
  }
});

test('a file tells the lineage of its objects', async () => {
  const asked = `PREFIX prov: <http://www.w3.org/ns/prov#> PREFIX clx: <https://w3id.org/cluxel/ontology#>
    SELECT ?object ?from { ?object a clx:Tree GRAPH <https://w3id.org/cluxel/graph/history> { ?object prov:wasDerivedFrom ?from } }`;
  const rows = JSON.parse(cluxel('query', join(folder, 'changed.clx'), '-e', asked, '--format', 'json')).results.bindings;
  assert.ok(rows.length > 0, 'the change touched a tree');
  const object = rows[0].object.value, wanted = rows.filter((row) => row.object.value === object).map((row) => row.from.value);
  const changed = await openPage(join(folder, 'changed.html'));
  try {
    await changed.page.evaluate((iri) => {
      const { store, model } = window.cluxelPage;
      store.set('selected', model.objectOf(iri));
    }, object);
    await changed.page.click('.lineage summary');
    await changed.page.waitForSelector('.lineage-list li');
    const told = await changed.page.$$eval('.lineage-list li', (items) => items.map((item) => item.title));
    assert.deepEqual(told.sort(), wanted.sort());
    assert.match(await changed.page.textContent('.lineage-list li small'), /retract/);
    assert.deepEqual(changed.faults, []);
  } finally {
    await changed.close();
  }
});
