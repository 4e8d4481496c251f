// SPDX-License-Identifier: Apache-2.0
// Texts that a question makes of times and numbers: the page's engine gives those of cluxel query, or the page says that
// it may not.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { ask, openPage } from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM, map = join(folder, 'visits.clx');
const open = pageOfAllTests(join(folder, 'visits.html'));
const pageAnswer = (text) => open.page.evaluate((asked) => window.cluxelPage.engine.ask(asked), text);

async function pageRows(text) {
  const answer = await pageAnswer(text);
  assert.equal(answer.form, 'rows', text);
  return answer.rows.map((row) => row.map((term) => term?.value));
}

function commandRows(text) {
  const answer = execFileSync(program, ['query', map, '-e', text, '--format', 'json'], { encoding: 'utf8', maxBuffer: 1e9, stdio: ['ignore', 'pipe', 'ignore'] });
  const { head, results } = JSON.parse(answer);
  return results.bindings.map((row) => head.vars.map((name) => row[name]?.value));
}

const TIMED = '?o clx:lastSeen ?t';
const SAME = [
  `SELECT (COUNT(*) AS ?n) { ${TIMED} FILTER(REGEX(STR(?t), "[.]0+Z")) }`,
  `SELECT ?day (COUNT(*) AS ?n) { ${TIMED} } GROUP BY (SUBSTR(str ( ?t # )
    ), 1, 24) AS ?day) ORDER BY ?day`,
  `SELECT (COUNT(*) AS ?n) { ${TIMED} } GROUP BY STR(?t) ORDER BY DESC(?n)`,
  `SELECT (STR(MIN(?t)) AS ?first) (xsd:string(MAX(?t)) AS ?last) (<http://www.w3.org/2001/XMLSchema#string>(MAX(?t)) AS ?same) { ${TIMED} }`,
  `SELECT ?c (STRLEN(GROUP_CONCAT(?t)) AS ?n) { ?o a ?c ; clx:lastSeen ?t } GROUP BY ?c HAVING(STRLEN(GROUP_CONCAT(?t)) > 30) ORDER BY ?c`,
  `SELECT (STRLEN(GROUP_CONCAT(?h; SEPARATOR = ", ;)")) AS ?n) { ?o clx:height ?h }`,
  'SELECT (SUM(STRLEN(STR(?h))) AS ?n) { ?o clx:heading|clx:height|clx:x ?h }',
  'SELECT (COUNT(DISTINCT ?text) AS ?n) { ?o clx:heading|clx:height|clx:x ?h BIND(STR(?h) AS ?text) }',
  'SELECT (STR(?least) AS ?text) { { SELECT (MIN(?h) AS ?least) { ?o clx:heading ?h FILTER(?h >= 0) } } }',
  `SELECT (${'STR('.repeat(30)}MIN(?t)${')'.repeat(30)} AS ?text) { ${TIMED} }`,
  'SELECT (STRLEN(STR(GROUP_CONCAT(STR(?t)))) AS ?n) { ?o clx:lastSeen ?t }',
  'SELECT (GROUP_CONCAT(?x) AS ?g) { VALUES ?x { "a"@en "b"@en } }',
  'SELECT (GROUP_CONCAT(?x) AS ?g) (STR(COALESCE(MIN(?none), "none")) AS ?n) (STR(COUNT(*)) AS ?c) { VALUES ?x { 1 UNDEF 2 } }',
  'SELECT (STR(?x) AS ?a) (STR(?y) AS ?b) (STR(20) AS ?c) { VALUES (?x ?y) { ("a"@en <urn:a>) (3 "2.50") } }',
  'SELECT (GROUP_CONCAT(?x) AS ?g) { VALUES ?x { <urn:a> "b" } }',
  'SELECT (GROUP_CONCAT(DISTINCT STR(?x); SEPARATOR="|") AS ?g) { VALUES ?x { 1 1 } }',
  'SELECT ("STR(?t)" AS ?text) (STR(?none) AS ?nothing) (STR(<urn:STR(>) AS ?iri) { }',
];
/** The page does not know the texts of these, or does not see that it does. */
const DOUBTFUL = [
  'SELECT (STR(SUM(?n)) AS ?text) (STR(SUM(?n) / 4) AS ?part) (STR(AVG(?n)) AS ?mean) { VALUES ?n { 2.0 4.0 } }',
  'SELECT (SUM(STRLEN(STR(?v))) AS ?n) { ?o a clx:Tree ; ?p ?v FILTER(!isBlank(?v)) }',
  'SELECT (STR(?v) AS ?text) { ?c clx:probability ?v }',
  'SELECT (STR(?v) AS ?text) { ?c !rdf:type ?v FILTER(isNumeric(?v)) }',
  ...['"2023-11-15T22:13:20Z"^^xsd:dateTime', 'xsd:dateTime("2023-11-15T22:13:20Z")', 'STRDT("2023-11-15T22:13:20Z", xsd:dateTime)', '2.0', '-1',
      '2.50', '1.0E0', '"007"^^xsd:integer', 'IF(1 < 2, 2.0, 3)', 'COALESCE(?none, 5.0)', '?t + "PT1S"^^xsd:dayTimeDuration']
    .flatMap((value) => [`SELECT (STR(${value}) AS ?text) {}`, `SELECT (STR(?x) AS ?text) { BIND(${value} AS ?x) }`]),
  ...['"2023-11-15T22:13:20Z"^^xsd:dateTime', '"3"^^xsd:decimal', '1.0E0', '"007"^^xsd:integer', '"1"^^xsd:boolean', '2.0']
    .map((value) => `SELECT (CONCAT("a", STR(MAX(?y))) AS ?text) { VALUES (?x ?y) { (1 ${value}) } }`),
  'SELECT (STR(?h) AS ?text) { { VALUES ?h { 2.0 } } UNION { BIND(1 + 1 AS ?h) } }',
  'SELECT (STR(?h) AS ?text) { { ?o clx:height ?h } UNION { SELECT (SUM(?n) AS ?h) { VALUES ?n { 1.0 1.0 } } } }',
];

test('STR, xsd:string and GROUP_CONCAT give the texts of cluxel query', async () => {
  for (const text of SAME) {
    const rows = commandRows(text);
    assert.ok(rows.length > 0, text);
    assert.deepEqual(await pageRows(text), rows, text);
    assert.deepEqual((await pageAnswer(text)).doubts, [], text);
  }
  assert.ok(Number(commandRows(SAME[0])[0][0]) > 0, 'some times have zeros at their end');
});

test('texts of values that are not surely as the map writes them are told as doubtful', async () => {
  for (const text of DOUBTFUL) assert.deepEqual((await pageAnswer(text)).doubts, ['texts'], text);
});

test('texts that are joined DISTINCT are told as doubtful where values of one text may differ', async () => {
  const joined = (what) => `SELECT (GROUP_CONCAT(DISTINCT ${what}) AS ?text) { VALUES ?x { 2 "2" } }`;
  assert.deepEqual([await pageRows(joined('?x')), commandRows(joined('?x'))], [[['2']], [['2 2']]]);
  assert.deepEqual((await pageAnswer(joined('?x'))).doubts, ['joined']);
  assert.deepEqual(await pageRows(joined('STR(?x)')), commandRows(joined('STR(?x)')));
  assert.deepEqual((await pageAnswer(joined('STR(?x)'))).doubts, []);
});

test('the parts that GROUP_CONCAT joins are those of cluxel query, in any order', async () => {
  for (const joined of ['?h', '?t', 'DISTINCT ?c', 'CONCAT(STR(?c), " ", STR(?t))']) {
    const text = `SELECT (GROUP_CONCAT(${joined}; SEPARATOR = "|") AS ?g) { ?o clx:seenThrough ?t ; clx:height ?h ; a ?c }`;
    const parts = ([[all]]) => all.split('|').sort();
    assert.deepEqual(parts(await pageRows(text)), parts(commandRows(text)), text);
    assert.ok(parts(commandRows(text)).length > 1, text);
  }
});

test('a time that the page shows is found by its text', async () => {
  const [[time]] = await pageRows(`SELECT ?t { ${TIMED} } LIMIT 1`);
  const text = `SELECT (COUNT(*) AS ?n) { ${TIMED} FILTER(STR(?t) = "${time}") }`;
  assert.ok(Number(commandRows(text)[0][0]) > 0);
  assert.deepEqual(await pageRows(text), commandRows(text));
});

test('a fault stands where the question as it was written has it', async () => {
  const faultOf = (text) => open.page.evaluate((asked) => window.cluxelPage.engine.ask(asked).then(() => '', (fault) => fault.message), text);
  const plain = await faultOf('SELECT (ABS(?t) AS ?x) { ?o clx:lastSeen ?t }} ');
  assert.match(plain, /^error at 1:/);
  assert.equal(await faultOf('SELECT (STR(?t) AS ?x) { ?o clx:lastSeen ?t }} '), plain);
});

test('below an answer stands that times and numbers as text may be written otherwise', async () => {
  const told = async (text) => {
    await ask(open.page, text);
    return open.page.textContent('.status:not(.fault)');
  };
  assert.match(await told('SELECT (STR(IF(?h > 1, ?h, 0.0)) AS ?text) { ?o clx:height ?h } LIMIT 1'), /\nTimes and numbers as text may be written otherwise.*cluxel query/);
  assert.match(await told('SELECT (STR(xsd:double(?h)) AS ?text) { ?o clx:height ?h } LIMIT 1'), /\nTimes and numbers as text/);
  const nested = await told(`SELECT (${'STR(CONCAT('.repeat(20)}STR(?t)${'))'.repeat(20)} AS ?text) { ${TIMED} } LIMIT 1`);
  assert.match(nested, /\nTimes and numbers as text may be written otherwise/);
  assert.match(await told('ASK { ?o clx:lastSeen ?t FILTER(STR(EXISTS { _:b clx:lastSeen ?t }) = "true") }'), /\nTimes and numbers as text/);
  assert.match(await told('SELECT (STR(?h) AS ?text) { ?o clx:height ?h } LIMIT 1'), /ms( · .*)?$/);
});

test('of numbers that a statement writes in another form the page says that it may not know the text', async () => {
  const { page, close } = await openPage(join(folder, 'markup.html'));
  const doubts = (text) => page.evaluate((asked) => window.cluxelPage.engine.ask(asked).then((answer) => answer.doubts), text);
  assert.deepEqual(await doubts('SELECT (STR(?v) AS ?text) { ?s <https://example.org/size> ?v }'), ['texts']);
  assert.deepEqual(await doubts('SELECT (STR(?v) AS ?text) { ?s <https://example.org/length> ?v }'), []);
  assert.deepEqual(await doubts('SELECT (STR(?h) AS ?text) { ?o clx:height ?h }'), []);
  await close();
});
