// SPDX-License-Identifier: Apache-2.0
// The layer of places: ways, junctions, crossings, regions and what rules derive.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { ask, drawn, seenWithoutGreenCones, settled } from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM;
const map = join(folder, 'campus.clx'), html = join(folder, 'campus.html');
const cluxel = (...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1e9 });
const rowsOf = (text) => JSON.parse(cluxel('query', map, '-e', text, '--format', 'json')).results.bindings
  .map((row) => Object.fromEntries(Object.entries(row).map(([name, term]) => [name, term.value])));
const CLX = 'https://w3id.org/cluxel/ontology#';
const open = pageOfAllTests(html);

const selectedPlace = (page) => page.evaluate(() => window.cluxelPage.store.state.place?.iri ?? null);

async function showPlaces(page) {
  await page.keyboard.press('l');
  await page.waitForSelector('.places li');
  await settled(page);
}

/** The pieces of lines of a place, as CSS pixels of the page. */
const piecesOnScreen = (page, iri) => page.evaluate((wanted) => {
  const { lines, viewer } = window.cluxelPage, canvas = viewer.renderer.domElement.getBoundingClientRect();
  const onScreen = (place) => {
    const at = place.clone().project(viewer.camera);
    return [canvas.left + (0.5 + 0.5 * at.x) * canvas.width, canvas.top + (0.5 - 0.5 * at.y) * canvas.height];
  };
  return lines.segments.filter(({ place }) => place.iri === wanted).map(({ from, to }) => [onScreen(from), onScreen(to)]);
}, iri);

test('the legend counts the places that cluxel query finds', async () => {
  await showPlaces(open.page);
  const types = rowsOf(`SELECT ?place ?class { ?place a clx:Place ; a ?class . ?class rdfs:subClassOf clx:Place }`);
  const classes = new Map();
  for (const { place, class: iri } of types) if (iri !== `${CLX}Place`) classes.set(place, [...(classes.get(place) ?? []), iri.slice(CLX.length)]);
  const wanted = {};
  for (const names of classes.values()) {
    const kind = ['Crossing', 'Road', 'Sidewalk', 'Path'].find((name) => names.includes(name)) ?? names[0];
    wanted[kind] = (wanted[kind] ?? 0) + 1;
  }
  const shown = await open.page.$$eval('.places li', (rows) => rows.map((row) => [row.dataset.class.replace(/.*#/, ''), Number(row.querySelector('.count').textContent)]));
  assert.ok(shown.length >= 2, 'the map holds ways');
  assert.deepEqual(Object.fromEntries(shown), wanted);
});

test('a way is drawn along its line in the colour of its kind, a little above the ground', async () => {
  await showPlaces(open.page);
  const way = rowsOf('SELECT ?way ?text { ?way a clx:Way ; clx:length ?length ; geo:hasGeometry/geo:asWKT ?text } ORDER BY DESC(?length)')[0];
  const corners = way.text.match(/-?[\d.]+ -?[\d.]+/g).map((pair) => pair.split(' ').map(Number));
  const drawnAs = await open.page.evaluate((iri) => {
    const { lines, viewer, model, stage } = window.cluxelPage, pieces = lines.segments.filter(({ place }) => place.iri === iri);
    const colours = lines.seen.geometry.getAttribute('instanceColorStart'), first = lines.segments.indexOf(pieces[0]);
    return { pieces: pieces.map(({ from, to }) => [from, to].map((at) => at.clone().add(viewer.origin).toArray())),
             high: pieces.map(({ from }) => from.z + viewer.origin.z - stage.ground.at(from.x + viewer.origin.x, from.y + viewer.origin.y)),
             colour: [colours.getX(first), colours.getY(first), colours.getZ(first)].map((value) => Math.round(255 * value)),
             wanted: pieces[0].place.info.color, kinds: [...new Set([...model.classes.values()].map((info) => info.color))].length };
  }, way.way);
  for (const [i, corner] of [[0, corners[0]], [drawnAs.pieces.length, corners.at(-1)]]) {
    const at = i === 0 ? drawnAs.pieces[0][0] : drawnAs.pieces[i - 1][1];
    assert.ok(Math.hypot(at[0] - corner[0], at[1] - corner[1]) < 1e-4, `${at} | ${corner}`);
  }
  const length = (pieces) => pieces.reduce((sum, [a, b]) => sum + Math.hypot(b[0] - a[0], b[1] - a[1]), 0);
  const wantedLength = length(corners.slice(1).map((corner, i) => [corners[i], corner]));
  assert.ok(Math.abs(length(drawnAs.pieces) - wantedLength) < 1e-3);
  assert.ok(drawnAs.high.every((height) => Math.abs(height - 0.3) < 1e-3));
  assert.equal(`#${drawnAs.colour.map((value) => value.toString(16).padStart(2, '0')).join('')}`, drawnAs.wanted);
});

test('a click on a line selects its place, whose card tells measures and rule', async () => {
  await open.again();  // the kinds that it hides stay hidden
  const { page } = open;
  await page.keyboard.press('t');
  await showPlaces(page);
  const way = rowsOf('SELECT ?way ?width ?length ?slope { ?way a clx:Way ; clx:width ?width ; clx:length ?length ; clx:slope ?slope } ORDER BY DESC(?length)')[0];
  for (const box of await page.$$('.places li:not([data-class$=Road]):not([data-class$=Path]):not([data-class$=Sidewalk]) input')) await box.uncheck();
  await drawn(page);
  const canvas = await page.locator('.view canvas').boundingBox(), legend = await page.locator('.legend').boundingBox();
  const middles = (await piecesOnScreen(page, way.way)).map(([a, b]) => [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
  const free = middles.filter(([x, y]) => x > legend.x + legend.width + 10 && x < canvas.x + canvas.width - 20 && y > 90 && y < canvas.height - 20);
  assert.ok(free.length > 0);
  let hit = null;
  for (const [x, y] of free) {
    await page.mouse.click(x, y);
    hit = await selectedPlace(page);
    if (hit === way.way) break;
  }
  assert.equal(hit, way.way);
  await page.waitForSelector('[aria-label="Selected place"] .why');
  const told = await page.textContent('[aria-label="Selected place"]');
  for (const [label, value, unit] of [['Width', way.width, ' m'], ['Length', way.length, ' m'], ['Slope', 100 * way.slope, ' %']])
    assert.ok(told.includes(`${label}${Number(Number(value).toFixed(unit === ' %' ? 1 : 2))}${unit}`), `${label} ${value}: ${told}`);
  const rule = readFileSync(join(process.env.CLUXEL_SOURCE, 'rules', '70_way_kinds.rq'), 'utf8');
  assert.equal(await page.textContent('[aria-label="Selected place"] pre'), rule);
  await page.keyboard.press('Escape');
  assert.equal(await selectedPlace(page), null);
});

test('kinds of places stay apart for an eye without green cones', async () => {
  await showPlaces(open.page);
  await open.page.selectOption('#colour-mode', 'distinct');
  const colours = await open.page.evaluate(() => {
    const { lines } = window.cluxelPage, colour = lines.seen.geometry.getAttribute('instanceColorStart'), kinds = new Map();
    lines.segments.forEach(({ place }, i) => kinds.set(place.info.label, [colour.getX(i), colour.getY(i), colour.getZ(i)].map((value) => Math.round(255 * value))));
    return [...kinds.values()].slice(0, 7);
  });
  assert.ok(colours.length >= 3);
  const seen = colours.map(seenWithoutGreenCones);
  for (let i = 0; i < seen.length; ++i)
    for (let k = 0; k < i; ++k) {
      const apart = Math.hypot(...seen[i].map((value, axis) => value - seen[k][axis]));
      assert.ok(apart > 12, `${colours[i]} and ${colours[k]}: ${apart}`);
    }
});

test('places are walked through by keyboard, and an object takes the place of a place', async () => {
  const { page } = open;
  await showPlaces(page);
  const first = page.locator('.places li .only').first();
  await first.focus();
  await page.keyboard.press('Enter');
  const one = await selectedPlace(page);
  await page.keyboard.press('Enter');
  const other = await selectedPlace(page);
  assert.ok(one && other && one !== other);
  await page.evaluate(() => window.cluxelPage.store.set('selected', window.cluxelPage.model.objects[0]));
  assert.equal(await selectedPlace(page), null);
  assert.equal(await page.locator('.card:not([hidden])').count(), 1);
  await page.keyboard.press('l');
  assert.equal(await page.evaluate(() => window.cluxelPage.lines.seen.visible), false);
  const nameless = await page.evaluate(() => [...document.querySelectorAll('.places button, .places input')]
    .filter((control) => !(control.getAttribute('aria-label') || control.labels?.[0]?.textContent.trim())).length);
  assert.equal(nameless, 0);
});

test('a row that names a place leads to it, and the address brings it back', async () => {
  await ask(open.page, `SELECT ?way { ?way a <${CLX}Way> } ORDER BY ?way`);
  const wanted = rowsOf('SELECT ?way { ?way a clx:Way } ORDER BY ?way')[0].way;
  assert.ok(!(await open.page.textContent('.ask .status')).includes('without a place'));
  await open.page.click('.answer tbody tr.live:first-child');
  assert.equal(await selectedPlace(open.page), wanted);
  await open.page.waitForFunction(() => location.hash.includes('place='));
  const hash = await open.page.evaluate(() => location.hash);
  await open.again(html, { hash });
  await open.page.waitForSelector('[aria-label="Selected place"]:not([hidden])');
  assert.equal(await selectedPlace(open.page), wanted);
});
