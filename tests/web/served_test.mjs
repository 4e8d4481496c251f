// SPDX-License-Identifier: Apache-2.0
// The page that cluxel serve gives: tasks, trials of rules, reasons and statements by its service.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { askNamed, states, writeText } from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM, map = join(folder, 'served.clx');
const page_address = `${process.env.CLUXEL_SERVICE.trim()}page`, token = readFileSync(join(folder, 'token'), 'utf8').trim();
const cluxel = (...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1e9 });
const open = pageOfAllTests(page_address);

async function askTask(page, name, values) {
  await page.click('#tab-tasks');
  await page.click(`[data-task="${name}"]`);
  for (const [key, value] of Object.entries(values)) await page.fill(`#task-${key}`, value);
  await page.click('.tasks .primary');
  await page.waitForFunction(() => document.querySelector('.tasks').getAttribute('aria-busy') === 'false' &&
                                   !document.querySelector('.tasks .actions').hidden, null, { timeout: 60_000 });
}

const taskOf = (name, ...values) => JSON.parse(cluxel('ask', map, name, ...values, '--json'));

test('a search is asked with its parameters, and its stops have numbered pins', async () => {
  const { page } = open, wanted = taskOf('search', 'for=StreetSign', 'from=0,0', 'stops=3');
  await askTask(page, 'search', { for: 'StreetSign', from: '0,0', stops: '3' });
  assert.ok(wanted.rows.length > 0);
  const column = wanted.columns.findIndex((one) => one.name === 'walk') + 2;
  const walks = await page.$$eval(`.tasks .answer tbody tr td:nth-child(${column})`, (cells) => cells.map((cell) => Number(cell.title)));
  assert.deepEqual(walks, wanted.rows.map((row) => row.walk));
  assert.deepEqual(await page.$$eval('.pin-mark', (pins) => pins.map((pin) => pin.textContent)), wanted.rows.map((_, i) => String(i + 1)));
  const places = await page.evaluate(() => window.cluxelPage.store.state.marks.map((mark) => mark.place.slice(0, 2)));
  assert.deepEqual(places, wanted.rows.map((row) => row.geometry.coordinates));
  const paths = await page.evaluate(() => window.cluxelPage.store.state.marks.map((mark) => mark.path));
  assert.deepEqual(paths, wanted.rows.map((row) => row.way));
  paths.forEach((path, i) => {
    if (!path) return;
    assert.deepEqual(path.at(-1), wanted.rows[i].geometry.coordinates, 'the way ends at its stop');
    const metres = path.slice(1).reduce((sum, corner, k) => sum + Math.hypot(corner[0] - path[k][0], corner[1] - path[k][1]), 0);
    assert.ok(Math.abs(metres - wanted.rows[i].walk) < 0.01, `${metres} m drawn, ${wanted.rows[i].walk} m told`);
  });
  assert.ok(paths.some(Boolean), 'the tour is drawn');
  assert.ok(await page.locator('.task-reasons li').count() > 0, 'stops tell why');
});

test('a route is drawn on the ground', async () => {
  const { page } = open;
  await askTask(page, 'route', { from: '0,0', to: '4,3' });
  const wanted = taskOf('route', 'from=0,0', 'to=4,3');
  const paths = await page.evaluate(() => window.cluxelPage.store.state.marks.map((mark) => mark.path));
  assert.deepEqual(paths, wanted.rows.map((row) => row.geometry.coordinates));
  const far = await page.evaluate(() => {
    const { store, model } = window.cluxelPage, ground = model.objectsOfClass('https://w3id.org/cluxel/ontology#Ground');
    const low = Math.min(...ground.map(({ box }) => box.z - box.height)), high = Math.max(...ground.map(({ box }) => box.z + box.height));
    return store.state.marks.filter((mark) => mark.place[2] < low - 0.5 || mark.place[2] > high + 0.5).length;
  });
  assert.equal(far, 0, 'pins stand near the ground');
});

test('rows of objects light them, and files are those of cluxel ask', async () => {
  const { page } = open;
  await askTask(page, 'inventory', { kind: 'Tree' });
  const lit = (await states(page)).filter((state) => state === 'lit').length;
  assert.equal(lit, taskOf('inventory', 'kind=Tree').rows.length);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('.tasks .actions >> text=CSV')]);
  assert.equal(readFileSync(await download.path(), 'utf8'), cluxel('ask', map, 'inventory', 'kind=Tree', '--format', 'csv'));
});

test('a refused value is told with the service\'s words', async () => {
  const { page } = open;
  await page.click('#tab-tasks');
  await page.click('[data-task=search]');
  await page.fill('#task-for', 'Spaceship');
  await page.click('.tasks .primary');
  await page.waitForSelector('.tasks .status.fault');
  assert.match(await page.textContent('.tasks .status.fault'), /Spaceship/);
  open.faults = open.faults.filter((fault) => !/status of 40[04]/.test(fault));  // the browser notes the answer's status
});

test('class words go to the service as they are typed, and mean what they mean to cluxel ask', async () => {
  const { page } = open;
  const asked = async (name, values) => {
    await askTask(page, name, values);
    return page.textContent('.tasks .status');
  };
  const own = taskOf('search', 'for=town sign', 'from=0,0'), other = taskOf('search', 'for=StreetSign', 'from=0,0');
  assert.notDeepEqual(own.notes, other.notes);
  assert.ok((await asked('search', { for: 'town sign', from: '0,0' })).includes(own.notes[0]));
  const kinds = taskOf('inventory', 'kind=Sokak Lambası', 'kind=tree');
  assert.ok(kinds.rows.length > 0);
  assert.match(await asked('inventory', { kind: 'Sokak Lambası, tree' }), new RegExp(`^${kinds.rows.length} rows`));
  await page.click('[data-task=search]');
  await page.fill('#task-for', 'double lamp');
  await page.click('.tasks .primary');
  await page.waitForSelector('.tasks .status.fault');
  assert.match(await page.textContent('.tasks .status.fault'), /names 2 classes/);
  const offered = await page.$$eval('#task-classes option', (options) => options.map((option) => option.value));
  assert.equal(new Set(offered).size, offered.length);
  assert.ok(offered.includes('StreetSign') && offered.includes('https://example.org/town#StreetSign'));
  open.faults = open.faults.filter((fault) => !/status of 404/.test(fault));
});

test('a changed threshold is tried, and coloured before and after', async () => {
  const { page } = open;
  await page.click('#tab-rules');
  const text = await page.inputValue('#rule-text'), changed = text.replace(/crown_top: 2\.2 m/, 'crown_top: 9 m');
  assert.notEqual(changed, text);
  await page.fill('#token', token);
  await writeText(page, '#rule-text', changed);
  await page.waitForFunction(() => /objects change/.test(document.querySelector('.rules .status').textContent), null, { timeout: 60_000 });
  const file = join(folder, 'changed.rules.yaml');
  execFileSync('tee', [file], { input: changed });
  let told;
  try { told = cluxel('rules', 'try', map, file, '--json'); } catch (fault) { told = fault.stdout; }  // 1: something differs
  const wanted = JSON.parse(told);
  assert.ok(wanted.changes.length > 0);
  assert.match(await page.textContent('.rules .status'), new RegExp(`^${wanted.changes.length} objects change; ${wanted.before} objects before, ${wanted.after} after`));
  for (const [kind, count] of Object.entries(wanted.counts))
    if (count > 0) assert.equal(Number(await page.textContent(`.rules [data-kind="${kind}"] b`)), count, kind);
  const tinted = () => page.evaluate(() => [...window.cluxelPage.store.state.tints].map(([number, colour]) => [window.cluxelPage.model.objects[number].id, colour.join()]));
  const before = wanted.changes.filter((change) => change.before).map((change) => change.before.id).sort();
  assert.deepEqual((await tinted()).map(([id]) => id).sort(), before);
  await page.check('#look-after');
  const colours = new Map(await tinted());
  const color = (name) => page.evaluate((iri) => {
    const value = parseInt(window.cluxelPage.model.classOf(iri).color.slice(1), 16);
    return [value >> 16, (value >> 8) & 255, value & 255].join();
  }, `https://w3id.org/cluxel/ontology#${name}`);
  for (const { before: from, after: to } of wanted.changes)
    if (from && to) assert.equal(colours.get(from.id), await color(to.class));
  await page.click('text=Undo all');
  assert.equal(await page.inputValue('#rule-text'), text);
  assert.equal(await page.evaluate(() => window.cluxelPage.store.state.tints), null);
});

test('faulty rules and a missing token are told', async () => {
  const { page } = open;
  await page.click('#tab-rules');
  await writeText(page, '#rule-text', 'rules: 7\n');
  await page.waitForSelector('.rules .status.fault');
  assert.match(await page.textContent('.rules .status.fault'), /token/i);
  await page.fill('#token', token);
  await page.waitForFunction(() => /posted\.rules\.yaml:1/.test(document.querySelector('.rules .status.fault')?.textContent ?? ''));
  open.faults = open.faults.filter((fault) => !/status of 40[01]/.test(fault));
});

test('why not a lamp is asked of the service', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.waitForSelector('#why-not');
  const id = await page.evaluate(() => window.cluxelPage.store.state.selected.id);
  await page.selectOption('#why-not', 'StreetLamp');
  await page.waitForSelector('.why-not-answer .why-not');
  const wanted = JSON.parse(cluxel('explain', map, id, '--why-not', 'StreetLamp', '--json'));
  assert.equal(await page.locator('.why-not-answer .why-not').count(), wanted.rules.length);
  assert.ok((await page.textContent('.why-not-answer')).includes(wanted.rules[0].rule));
});

test('the lineage of an object comes from the history', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.click('.lineage summary');
  await page.waitForSelector('.lineage-list > *');
  assert.match(await page.textContent('.lineage-list'), /made by the build/);
});

test('a statement needs something stated, and offers classes that can be stated, each told from the others', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  await page.click('text=Wrong class, or something to say?');
  assert.ok(await page.isDisabled('text=Save in the map'));
  assert.equal(await page.textContent('.correction .statement'), '');
  await page.fill('#remark', '  ');
  assert.ok(await page.isDisabled('text=Save in the map'));
  const offered = await page.$$eval('#right-class option', (options) => options.map((option) => [option.value, option.textContent]).slice(1));
  const titles = offered.map(([, title]) => title), iris = offered.map(([iri]) => iri);
  assert.equal(new Set(titles).size, titles.length);
  for (const name of ['Tree', 'StreetLamp', 'Vehicle']) assert.ok(iris.includes(`https://w3id.org/cluxel/ontology#${name}`), name);
  for (const name of ['Ground', 'Cloud', 'TreeTrunk', 'OperatorStatement', 'Object'])
    assert.ok(!iris.includes(`https://w3id.org/cluxel/ontology#${name}`), name);
  const things = await page.evaluate(() => window.cluxelPage.model.objects.filter(({ class: { label } }) => label !== 'ground').map(({ iri }) => iri));
  assert.ok(things.length >= iris.length, 'each class is stated of a thing of its own');
  const tried = join(folder, 'every_class.clx');
  execFileSync('cp', [map, tried]);
  cluxel('update', tried, '-e', `INSERT DATA { ${iris.map((iri, i) => `<${things[i]}> a <${iri}> .`).join('\n')} }`);  // throws when one is refused
  await page.selectOption('#right-class', 'https://example.org/town#StreetSign');
  assert.ok(await page.isEnabled('text=Save in the map'));
});

test('a statement is saved in the map for those who have the token', async () => {
  const { page } = open;
  await askNamed(page, 'trees.rq');
  await page.click('.answer tbody tr.live:first-child');
  const iri = await page.evaluate(() => window.cluxelPage.store.state.selected.iri);
  await page.click('text=Wrong class, or something to say?');
  await page.fill('#remark', 'seen by the test');
  await page.click('#tab-rules');
  await page.fill('#token', token);
  await page.click('text=Save in the map');
  await page.waitForFunction(() => /Saved/.test(document.querySelector('.correction').textContent));
  assert.match(await page.textContent('.correction'), /load it anew to see the statement/);
  assert.ok(await page.isVisible('.changed'), 'the page is of the map without the statement');
  const told = JSON.parse(cluxel('query', map, '-e', `SELECT ?label { <${iri}> <http://www.w3.org/2000/01/rdf-schema#label> ?label }`, '--format', 'json'));
  assert.ok(told.results.bindings.some((row) => row.label.value === 'seen by the test'));
});
