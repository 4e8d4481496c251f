// SPDX-License-Identifier: Apache-2.0
// The page in a browser. page_test.sh makes the maps and pages, and sets the variables CLUXEL_… that name them.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import {
  answered, ask, askNamed, coveredPixels, drawn, editorText, placeOf, seenWithoutGreenCones, settled, states,
} from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM;
const map = join(folder, 'campus.clx'), html = join(folder, 'campus.html');
const cluxel = (...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1e9 });
const questions = JSON.parse(cluxel('tasks', '--json')).filter((task) => task.file);
const open = pageOfAllTests(html);

const firstRow = '.answer tbody tr.live:first-child';
const cardTitle = (page) => page.textContent('.card h2');
const selectedId = (page) => page.evaluate(() => window.cluxelPage.store.state.selected?.id ?? null);
const close = (a, b) => a === b || Math.abs(Number(a) - Number(b)) < 1e-9;

/** The rows of the page's engine for the text in the editor, as cluxel's JSON holds them. */
async function pageAnswer(page) {
  const answer = await page.evaluate((text) => window.cluxelPage.engine.ask(text), await editorText(page));
  return { variables: answer.variables, rows: answer.rows.map((row) => row.map((term) => term?.value ?? null)) };
}

function programAnswer(file, ...params) {
  const { head, results } = JSON.parse(cluxel('query', map, file, '--format', 'json', ...params));
  return { variables: head.vars, rows: results.bindings.map((row) => head.vars.map((name) => row[name]?.value ?? null)) };
}

function assertSameAnswer(page, wanted, name) {
  assert.deepEqual(page.variables, wanted.variables, name);
  assert.equal(page.rows.length, wanted.rows.length, `${name}: number of rows`);
  wanted.rows.forEach((row, i) => row.forEach((value, k) => assert.ok(close(value, page.rows[i][k]), `${name}, row ${i}: ${value} | ${page.rows[i][k]}`)));
}

test('the file opens offline and names its map', async () => {
  assert.equal(await open.page.title(), 'campus · Cluxel');
  const about = JSON.parse(cluxel('info', map, '--json')), text = await open.page.textContent('.title p');
  assert.ok(text.includes(`${about.objects} objects`), text);
});

test('every shipped question has the answer of cluxel query', async () => {
  assert.ok(questions.length >= 10);
  for (const { file } of questions) {
    await askNamed(open.page, file);
    assertSameAnswer(await pageAnswer(open.page), programAnswer(file), file);
  }
});

test('parameters of a question are bound', async () => {
  await askNamed(open.page, 'near_point.rq');
  await open.page.fill('#parameter-radius', '25');
  await open.page.press('#parameter-radius', 'Enter');
  await answered(open.page);
  const wanted = programAnswer('near_point.rq', '--param', 'radius=25');
  assert.ok(wanted.rows.length > programAnswer('near_point.rq').rows.length);
  assertSameAnswer(await pageAnswer(open.page), wanted, 'near_point.rq');
});

test('an answer lights up its objects and dims the others', async () => {
  assert.deepEqual([...new Set(await states(open.page))], ['plain']);
  await askNamed(open.page, 'trees.rq');
  const trees = new Set(programAnswer('trees.rq').rows.map((row) => row[0].slice(-32)));
  const ids = await open.page.evaluate(() => window.cluxelPage.model.objects.map((object) => object.id));
  (await states(open.page)).forEach((state, i) => assert.equal(state, trees.has(ids[i]) ? 'lit' : 'dimmed'));
  await open.page.click('.actions >> text=Clear');
  assert.deepEqual([...new Set(await states(open.page))], ['plain']);
});

test('parts and classes in a row stand for their objects', async () => {
  await ask(open.page, 'SELECT ?part { ?part a <https://w3id.org/cluxel/ontology#TreeTrunk> ; <https://w3id.org/cluxel/ontology#partOf> ?tree }');
  assert.ok((await states(open.page)).includes('lit'));
  await askNamed(open.page, 'count_by_class.rq');
  await open.page.click(firstRow);
  const lit = (await states(open.page)).filter((state) => state === 'lit').length;
  assert.equal(lit, Number(programAnswer('count_by_class.rq').rows[0][1]));
});

test('a row and its object are one selection', async () => {
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  const id = programAnswer('trees.rq').rows[0][0].slice(-32);
  assert.equal(await selectedId(open.page), id);
  assert.equal(await cardTitle(open.page), 'Tree');
  assert.equal(await open.page.getAttribute(firstRow, 'aria-selected'), 'true');
});

test('a click on a point selects its object', async () => {
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  await drawn(open.page);
  const id = await selectedId(open.page);
  await open.page.click('[aria-label^="Close the card"]');
  assert.equal(await selectedId(open.page), null);
  await settled(open.page);
  const at = await placeOf(open.page, id);
  await open.page.mouse.click(at.x, at.y);
  assert.equal(await selectedId(open.page), id);
});

test('what is hidden is neither seen nor clicked', async () => {
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  await drawn(open.page);
  const id = await selectedId(open.page);
  await open.page.click('[aria-label^="Close the card"]');
  await settled(open.page);
  const at = await placeOf(open.page, id);
  await open.page.uncheck('[data-class="https://w3id.org/cluxel/ontology#Tree"]');
  assert.ok((await states(open.page)).includes('hidden'));
  await open.page.mouse.click(at.x, at.y);
  const selected = await open.page.evaluate(() => window.cluxelPage.store.state.selected?.class.label ?? null);
  assert.notEqual(selected, 'tree');
});

test('classes stay apart for an eye without green cones', async () => {
  await open.page.selectOption('#colour-mode', 'distinct');
  const colours = await open.page.evaluate(() => {
    const { model, viewer } = window.cluxelPage;
    return model.shownClasses.filter(({ info }) => info.label !== 'ground').slice(0, 7).map(({ info }) => viewer.palette.classColour(info.iri));
  });
  assert.equal(colours.length, 7);
  const seen = colours.map(seenWithoutGreenCones);
  for (let i = 0; i < seen.length; ++i)
    for (let k = 0; k < i; ++k) {
      const apart = Math.hypot(...seen[i].map((value, axis) => value - seen[k][axis]));
      assert.ok(apart > 12, `${colours[i]} and ${colours[k]}: ${apart}`);
    }
});

test('sliders cut heights and scans', async () => {
  const slide = async (id, value) => {
    await open.page.$eval(`#${id}`, (slider, wanted) => {
      slider.value = wanted;
      slider.dispatchEvent(new Event('input'));
    }, String(value));
    await settled(open.page);
  };
  const whole = await coveredPixels(open.page);
  await slide('slice-low', 2);
  const high = await coveredPixels(open.page);
  await slide('slice-low', -2);
  await slide('slice-high', 2);
  const low = await coveredPixels(open.page);
  assert.ok(high > 0 && high < 0.9 * whole && low > 0 && low < whole, `${whole}, above 2 m ${high}, below ${low}`);
  await slide('slice-high', 30);
  await slide('last-scan', 0);
  const first = await coveredPixels(open.page);
  assert.ok(first > 0 && first < 0.8 * whole, `the first of three scans covers ${first} of ${whole}`);
  assert.match(await open.page.textContent('.legend'), /scan_000/);
  await slide('last-scan', 2);
  assert.equal(await coveredPixels(open.page), whole);
});

test('the card shows the points of its object alone', async () => {
  await open.again();
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  // Whoever asks first makes the context, and Chromium warns of one that was not made to be read.
  await open.page.waitForFunction(() => {
    const canvas = document.querySelector('.portrait');
    const context = canvas.getContext('2d', { willReadFrequently: true });
    return context.getImageData(0, 0, canvas.width, canvas.height).data.some((value) => value > 0);
  });
  const picture = await open.page.$eval('.portrait', (canvas) => {
    const context = canvas.getContext('2d'), colours = new Map();
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    for (let i = 0; i < data.length; i += 4)
      if (data[i + 3] > 0) colours.set(data[i + 1] > data[i] && data[i + 1] > data[i + 2], (colours.get(true) ?? 0) + 1);
    return [...colours.keys()];
  });
  assert.deepEqual(picture, [true], 'green, and nothing else');
});

test('the card tells why, as cluxel explain does', async () => {
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  await open.page.waitForSelector('.why');
  const wanted = JSON.parse(cluxel('explain', map, await selectedId(open.page), '--json'));
  const accepted = wanted.decisions.find((decision) => decision.accepted);
  assert.equal(await open.page.textContent('.why summary'), 'Why Tree?');
  assert.equal(await open.page.locator('.why .step').count(), accepted.path.length);
  assert.ok((await open.page.textContent('.why .step')).includes(accepted.path[0].test.replaceAll('_', ' ')));
  const weighed = accepted.evidence.length > 1 || accepted.rivals !== undefined;
  assert.equal(await open.page.locator('.why .evidence tr').count(), weighed ? accepted.evidence.length : 0);
  assert.equal(await open.page.locator('.why .evidence .rival').count(), accepted.rivals?.length ?? 0);
  const others = wanted.decisions.filter((decision) => !decision.accepted).length;
  assert.equal(await open.page.locator('.why-not').count(), others);
});

test('the card lists the facts and the scans of its object', async () => {
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  await open.page.click('text=All facts and observations');
  await open.page.waitForSelector('.fact-table');
  const seen = programAnswer('seen_from.rq').rows.find((row) => row[0] === programAnswer('trees.rq').rows[0][0]);
  assert.ok((await open.page.textContent('.facts')).includes(`Seen in ${seen[2]} scan`));
});

test('everything is done by keyboard', async () => {
  const { page } = open;
  await page.keyboard.press('q');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'question');
  await askNamed(page, 'trees.rq');
  await page.focus(firstRow);
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  assert.equal(await selectedId(page), programAnswer('trees.rq').rows[1][0].slice(-32));
  await page.keyboard.press('n');
  assert.equal(await selectedId(page), programAnswer('trees.rq').rows[2][0].slice(-32));
  for (const [key, state] of [['b', 'boxes'], ['m', 'measuring'], ['p', 'sensorPath']]) {
    await page.keyboard.press(key);
    assert.equal(await page.evaluate((name) => window.cluxelPage.store.state[name], state), true, key);
  }
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('dialog.help'));
  await page.keyboard.press('Escape');
  for (const _ of [1, 2, 3]) await page.keyboard.press('Escape');
  assert.equal(await page.evaluate(() => window.cluxelPage.store.state.lit), null);
});

test('every control has a name for screen readers', async () => {
  await askNamed(open.page, 'near_point.rq');
  const nameless = await open.page.evaluate(() => [...document.querySelectorAll('button, input, select, textarea, canvas')]
    .filter((control) => !control.closest('.CodeMirror') &&
            !(control.getAttribute('aria-label') || control.textContent.trim() || control.labels?.[0]?.textContent.trim()))
    .map((control) => control.outerHTML));
  assert.deepEqual(nameless, []);
});

test('the address brings camera, selection and question back', async () => {
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  await open.page.waitForFunction(() => location.hash.includes('object=') && location.hash.includes('question='));
  await open.page.waitForTimeout(400);
  const state = () => window.cluxelPage.viewer.camera.position.toArray().map((value) => Math.round(value * 10));
  const hash = await open.page.evaluate(() => location.hash), [camera, id] = [await open.page.evaluate(state), await selectedId(open.page)];
  await open.again(html, { hash });
  await open.page.waitForSelector(firstRow);
  assert.deepEqual(await open.page.evaluate(state), camera);
  assert.equal(await selectedId(open.page), id);
  assert.equal(await open.page.inputValue('#question'), 'trees.rq');
});

test('a faulty question is told with its place', async () => {
  await ask(open.page, 'SELECT ?x { ?x');
  assert.ok(await open.page.isVisible('.status.fault'));
  assert.match(await open.page.textContent('.status'), /^Line 1, column \d+: the question cannot be read here/);
  await ask(open.page, 'ASK { ?s ?p ?o }');
  assert.match(await open.page.textContent('.status'), /^Yes/);
});

test('answers are downloaded as CSV and GeoJSON', async () => {
  await askNamed(open.page, 'trees.rq');
  const saved = async (name) => {
    const [download] = await Promise.all([open.page.waitForEvent('download'), open.page.click(`.actions >> text=${name}`)]);
    return readFileSync(await download.path(), 'utf8');
  };
  assert.equal(await saved('CSV'), cluxel('query', map, 'trees.rq', '--format', 'csv'));
  const { features } = JSON.parse(await saved('GeoJSON')), wanted = programAnswer('trees.rq').rows;
  assert.deepEqual(features.map((feature) => feature.id), wanted.map((row) => row[0].slice(-32)));
  for (const { geometry } of features) assert.deepEqual(geometry.coordinates[0][0], geometry.coordinates[0].at(-1));
  await ask(open.page, 'SELECT ?n { VALUES ?n { 1 2 } }');
  assert.deepEqual(JSON.parse(await saved('GeoJSON')).features,
                   ['1', '2'].map((n) => ({ type: 'Feature', geometry: null, properties: { n } })), 'rows without a place');
});

test('a measured distance is that of the two points', async () => {
  await open.page.keyboard.press('t');
  await drawn(open.page);
  await open.page.keyboard.press('m');
  const canvas = await open.page.locator('.view canvas').boundingBox();
  const hits = [];
  for (let i = 0; hits.length < 2 && i < 60; ++i) {
    const at = { x: canvas.width * (0.35 + 0.006 * i * (hits.length + 1)), y: canvas.height * (0.4 + 0.004 * i) };
    await open.page.mouse.click(canvas.x + at.x, canvas.y + at.y);
    const text = await open.page.textContent('.measure');
    if (text.includes('second') && hits.length === 0) hits.push(at);
    else if (text.includes('Distance')) hits.push(at);
  }
  assert.equal(hits.length, 2);
  const [all, plan, height] = await open.page.$$eval('.measure b', (cells) => cells.map((cell) => parseFloat(cell.textContent)));
  assert.ok(all > 1 && Math.abs(all - Math.hypot(plan, height)) < 0.02, `${all} ${plan} ${height}`);
  const { camera, controls } = await open.page.evaluate(() => {
    const { viewer } = window.cluxelPage;
    return { camera: viewer.camera.position.toArray(), controls: viewer.controls.target.toArray() };
  });
  const metresPerPixel = 2 * Math.tan((25 * Math.PI) / 180) * (camera[2] - controls[2]) / canvas.height;
  const seen = Math.hypot(hits[0].x - hits[1].x, hits[0].y - hits[1].y) * metresPerPixel;
  assert.ok(Math.abs(plan - seen) < 0.25 * seen + 1, `${plan} m against ${seen} m on the screen`);
});

test('a narrow screen shows everything in one column', async () => {
  await open.again(html, { width: 390, height: 780 });
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  const { wide, tall } = await open.page.evaluate(() => ({ wide: document.documentElement.scrollWidth, tall: document.documentElement.scrollHeight }));
  assert.ok(wide <= 390 && tall <= 780, `${wide} x ${tall}`);
  assert.ok(await open.page.isVisible('.card h2') && await open.page.isVisible('.view canvas'));
});

test('labels, names and texts of the map are never markup', async () => {
  await open.again(join(folder, 'markup.html'));
  await askNamed(open.page, 'trees.rq');
  await open.page.click(firstRow);
  await open.page.click('text=All facts and observations');
  await open.page.waitForSelector('.fact-table');
  assert.ok((await open.page.textContent('.facts')).includes('<img src=x onerror="window.wasRun=1">'));
  assert.ok((await open.page.textContent('.card h2')).includes('</script><script>window.wasRun=1</script>'));
  assert.equal(await open.page.evaluate(() => window.wasRun), undefined);
  assert.equal(await open.page.locator('img').count(), 0);
});

test('the policy stops scripts that are not the page\'s own', async () => {
  await open.page.evaluate(() => {
    const script = document.createElement('script');
    script.textContent = 'window.wasRun = 1';
    document.body.append(script);
  });
  assert.equal(await open.page.evaluate(() => window.wasRun), undefined);
  const said = open.faults.splice(0);
  assert.ok(said.length > 0 && said.every((fault) => fault.includes('Content Security Policy')), said.join('\n'));
});

test('licences of all packages are shown', async () => {
  await open.page.keyboard.press('?');
  await open.page.click('text=Licences of what this page is made of');
  await open.page.waitForFunction(() => document.querySelector('.help pre').textContent.length > 1000);
  const text = await open.page.textContent('.help pre');
  for (const name of ['three', 'oxigraph', '@zazuko/yasqe', 'codemirror']) assert.ok(text.includes(`${name} `), name);
});
