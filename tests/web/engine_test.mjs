// SPDX-License-Identifier: Apache-2.0
// Where the page's SPARQL engine could differ from cluxel query: GeoSPARQL functions, datasets, empty graphs, positions.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { ask, askNamed } from './browser.mjs';
import { pageOfAllTests } from './open_pages.mjs';

const folder = process.env.CLUXEL_PAGES, program = process.env.CLUXEL_PROGRAM;
const map = join(folder, 'campus.clx'), html = join(folder, 'campus.html');
const GRAPH = 'https://w3id.org/cluxel/graph/', GEOF = 'http://www.opengis.net/def/function/geosparql/';
const PREFIXES = `PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX geo: <http://www.opengis.net/ont/geosparql#>
  PREFIX geof: <${GEOF}> PREFIX g: <${GRAPH}>\n`;
const open = pageOfAllTests(html);

/** What the page's engine answers, or the fault that it tells. */
const pageAnswer = (text) => open.page.evaluate(
  (asked) => window.cluxelPage.engine.ask(asked).catch((fault) => ({ form: 'fault', message: fault.message })), text);

function countsOf(text) {
  const answer = execFileSync(program, ['query', map, '-e', text, '--format', 'json'], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  const { head, results } = JSON.parse(answer);
  return results.bindings.map((row) => head.vars.map((name) => row[name].value));
}

async function pageCounts(text) {
  const answer = await pageAnswer(text);
  assert.equal(answer.form, 'rows', `${text}: ${answer.message}`);
  return answer.rows.map((row) => row.map((term) => term.value));
}

test('GeoSPARQL functions are refused, however they are written', async () => {
  const names = ['distance', 'sfIntersects', 'sfDisjoint', 'sfWithin', 'sfContains', 'sfTouches', 'envelope', 'area', 'length',
                 'union', 'getSRID', 'rcc8dc', 'ehMeet', 'relate', 'asGeoJSON'];
  const shapes = '{ ?a geo:asWKT ?wa . ?b geo:asWKT ?wb';
  const calls = names.map((name) => [name, `${PREFIXES} SELECT (geof:${name}(?wa, ?wb) AS ?x) ${shapes} } LIMIT 1`]);
  const distances = [
    `${PREFIXES} SELECT (COUNT(*) AS ?n) ${shapes} FILTER(geof:distance(?wa, ?wb, <http://www.opengis.net/def/uom/OGC/1.0/metre>) < 10) }`,
    `${PREFIXES} PREFIX far: <${GEOF}dis> SELECT * ${shapes} FILTER(far:tance(?wa, ?wb) < 10) }`,
    `${PREFIXES} SELECT * ${shapes} FILTER(1<<${GEOF}distance>(?wa, ?wb)) }`,
    `BASE <${GEOF}> ${PREFIXES} ASK ${shapes} FILTER(<distance>(?wa, ?wb)<5) }`,
    `${PREFIXES} SELECT * ${shapes} FILTER(5<geof:distance(?wa,?wb)&&?n>4) }`,
    `${PREFIXES} SELECT * ${shapes} FILTER NOT EXISTS { ?c geo:asWKT ?wc FILTER(<${GEOF}dist\\u0061nce>(?wa, ?wc) < 1) } }`,
    `${PREFIXES} CONSTRUCT { ?a ?b ?x } ${shapes} BIND(geof:distance(?wa, ?wb) AS ?x) }`,
    `${PREFIXES} SELECT ?a ${shapes} } ORDER BY geof:distance(?wa, ?wb)`,
  ];
  for (const [name, text] of [...calls, ...distances.map((one) => ['distance', one])]) {
    const answer = await pageAnswer(text);
    assert.equal(answer.form, 'fault', text);
    assert.match(answer.message, new RegExp(`^The page has no function <${GEOF}${name}>.*cluxel query`), text);
  }
  await ask(open.page, distances[0]);
  assert.match(await open.page.textContent('.status.fault'), /geosparql\/distance>\. Ask with cluxel query/);
});

test('a text, a comment or an IRI that names a GeoSPARQL function calls none', async () => {
  const text = `${PREFIXES} SELECT (COUNT(*) AS ?n) ("geof:distance(?wa, ?wb)" AS ?text) (<${GEOF}distance> AS ?iri)
    { ?a geo:asWKT ?wa # FILTER(geof:distance(?wa, ?wa) < 10)
    }`;
  assert.deepEqual(await pageCounts(text), countsOf(text));
});

test('FROM and FROM NAMED choose the graphs as in cluxel query', async () => {
  const texts = [
    'SELECT (COUNT(*) AS ?n) { ?s ?p ?o }',
    'SELECT (COUNT(*) AS ?n) FROM g:inferred { ?s ?p ?o }',
    `SELECT (COUNT(*) AS ?n) FROM <${GRAPH}inferred>\nFrom\t<${GRAPH}ontology> WHERE { ?s ?p ?o }`,
    `SELECT (COUNT(*)<3 AS ?few)(COUNT(*) AS ?n)FROM<${GRAPH}none>{ ?s ?p ?o }`,
    'SELECT (COUNT(*) AS ?n) FROM NAMED g:inferred { ?s ?p ?o }',
    'SELECT (COUNT(*) AS ?n) FROM NAMED g:inferred { GRAPH ?g { ?s ?p ?o } }',
    'SELECT (COUNT(*) AS ?n) FROM g:ontology FROM NAMED g:inferred { ?s a ?class GRAPH ?g { ?thing a ?class } }',
    'SELECT ?p (COUNT(*) AS ?n) # all\nFROM g:ontology { ?s ?p ?o } GROUP BY ?p ORDER BY ?p',
    'SELECT (COUNT(*) AS ?n) (EXISTS { ?x a "from <a>" } AS ?y) FROM # from\n g:ontology { ?s ?p ?o }',
    // FROM as part of something else leaves the union.
    'SELECT (COUNT(*) AS ?n) # FROM g:inferred\n { ?s ?p ?o }',
    `SELECT (COUNT(*) AS ?n) ("all FROM <${GRAPH}inferred>" AS ?text) { ?s ?p ?o }`,
    "SELECT (COUNT(*) AS ?n) ('''it's\nFROM <g>''' AS ?text) { ?s ?p ?o }",
    'SELECT (COUNT(*) AS ?n) (MIN(?from) AS ?least) { ?from ?p ?o . FILTER(isIRI(?from) ) } # from <x>',
    'PREFIX from: <http://x/>\nSELECT (COUNT(*) AS ?n) (SAMPLE(from:a) AS ?a) { ?s ?p ?o FILTER(?p != from:from ) }',
  ];
  for (const text of texts.map((one) => PREFIXES + one)) assert.deepEqual(await pageCounts(text), countsOf(text), text);
  assert.notDeepEqual(countsOf(PREFIXES + texts[0]), countsOf(PREFIXES + texts[1]));
  const asked = await pageAnswer(`${PREFIXES} ASK FROM g:none { ?s ?p ?o }`);
  assert.deepEqual([asked.form, asked.value], ['truth', false]);
});

test('names that the page does not have are told with the answer', async () => {
  const told = async (text) => {
    await ask(open.page, text);
    return open.page.textContent('.status:not(.fault)');
  };
  assert.match(await told('ASK { ?s a clx:Tre }'), /^No · .*\nThe page has no class clx:Tre\. Did you mean clx:Tree\?$/);
  assert.match(await told('SELECT * { ?s clx:heigth ?o }'), /^0 rows · .*\nThe page has no clx:heigth\. Did you mean clx:height\?$/);
  assert.match(await told(`SELECT (COUNT(*) AS ?n) FROM <${GRAPH}nix> { ?s ?p ?o }`), /\nThe page has no graph https:\/\/.*\/nix\.$/);
  assert.match(await told(`ASK { GRAPH <${GRAPH}history> { ?s ?p ?o } }`), /\nThe graph of the history is not in the page: cluxel query has it\.$/);
  assert.match(await told('SELECT * { ?o a clx:Tree FILTER(?radius > 1) }'), /\n\?radius has no value: no pattern binds it\.$/);
  for (const right of ['SELECT * { ?o a clx:Tree ; clx:height ?h } LIMIT 3', `ASK { GRAPH <${GRAPH}inferred> { ?s ?p ?o } }`,
                       'SELECT * { ?o a clx:Tree FILTER(xsd:integer(1.0) = 1) } LIMIT 1'])
    assert.match(await told(right), /ms$/, right);
});

test('the known prefixes need no PREFIX line, and others are told with their place', async () => {
  const bare = 'SELECT (COUNT(*) AS ?n) { ?o a clx:Tree ; rdf:type ?type }';
  assert.deepEqual(await pageCounts(bare), countsOf(bare));
  const own = `PREFIX clx: <http://own/> ${bare}`;
  assert.deepEqual(await pageCounts(own), countsOf(own));
  const fault = async (text) => {
    await ask(open.page, text);
    return open.page.textContent('.status.fault');
  };
  assert.match(await fault('SELECT * {\n ?o a my:Tree }'), /^Line 2, column 7: .*the prefix my: is not declared; begin the question with PREFIX my:/);
  const wrong = await fault('SELECT * { ?o a clx:Tree ; }} ');
  assert.match(wrong, /^Line 1, column 31: the question cannot be read here: cluxel query --check/);
  assert.equal(await fault('PREFIX clx: <urn:> SELECT * { ?o a clx:Tree ; }} '), wrong.replace('31', '50'));
  assert.doesNotMatch(wrong, /\.\.=|Prefix not found|expected/);
});

test('times are told as the map writes them, so that a copied one is found', async () => {
  const texts = ['SELECT ?cloud ?time { ?cloud a clx:Cloud ; <http://www.w3.org/ns/sosa/resultTime> ?time } ORDER BY ?cloud',
                 'SELECT (MAX(?time) AS ?last) { ?cloud <http://www.w3.org/ns/sosa/resultTime> ?time }'];
  for (const text of texts.map((one) => PREFIXES + one)) assert.deepEqual(await pageCounts(text), countsOf(text), text);
  const time = (await pageCounts(PREFIXES + texts[1]))[0][0];
  const copied = `${PREFIXES} SELECT (COUNT(*) AS ?n) { ?cloud a clx:Cloud ; <http://www.w3.org/ns/sosa/resultTime>
    "${time}"^^<http://www.w3.org/2001/XMLSchema#dateTime> }`;
  assert.deepEqual(countsOf(copied), [['1']]);
  assert.deepEqual(await pageCounts(copied), [['1']]);
});

test('a CONSTRUCT or DESCRIBE that finds nothing is an empty graph', async () => {
  for (const text of ['CONSTRUCT { ?o a clx:Nope } WHERE { ?o a clx:Nope }', 'DESCRIBE <http://nope/>', 'CONSTRUCT FROM g:none WHERE { ?s ?p ?o }']) {
    const answer = await pageAnswer(PREFIXES + text);
    assert.deepEqual([answer.form, answer.triples], ['graph', []], text);
    await ask(open.page, PREFIXES + text);
    assert.match(await open.page.textContent('.status:not(.fault)'), /^0 rows/, text);
  }
  const empty = await pageAnswer(`${PREFIXES} SELECT ?b ?a { ?a a clx:Nope ; ?p ?b }`);
  assert.deepEqual([empty.form, empty.variables, empty.rows], ['rows', ['b', 'a'], []]);
  const full = await pageAnswer(`${PREFIXES} CONSTRUCT { ?tree a clx:Tree } { ?tree a clx:Tree }`);
  assert.ok(full.form === 'graph' && full.triples.length > 0);
});

test('the position on the card is that of the question, not the middle of the box', async () => {
  await askNamed(open.page, 'trees.rq');
  const texts = await open.page.evaluate((text) => window.cluxelPage.engine.ask(text),
                                         `${PREFIXES} SELECT ?tree ?x ?y { ?tree a clx:Tree ; clx:x ?x ; clx:y ?y } ORDER BY ?tree`);
  let apart = 0;
  for (const [tree, x, y] of texts.rows.slice(0, 5).map((row) => row.map((term) => term.value))) {
    const box = await open.page.evaluate((iri) => {
      const { store, model } = window.cluxelPage;
      store.set('selected', model.objectOf(iri));
      return model.objectOf(iri).box;
    }, tree);
    await open.page.waitForFunction(() => /\d m$/.test(document.querySelector('.measures [data-measure=position]')?.textContent ?? ''));
    const shown = (await open.page.textContent('.measures [data-measure=position]')).split(',').map(parseFloat);
    assert.ok(Math.abs(shown[0] - x) < 0.0051 && Math.abs(shown[1] - y) < 0.0051, `${shown} against ${x}, ${y}`);
    apart = Math.max(apart, Math.hypot(box.x - x, box.y - y));
  }
  assert.ok(apart > 0.02, 'of one tree at least the two places differ');
});
