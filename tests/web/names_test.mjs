// SPDX-License-Identifier: Apache-2.0
// The names that the page reads out of a query. This needs no browser.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';

const web = join(process.env.CLUXEL_SOURCE, 'web'), { build } = createRequire(join(web, 'build.mjs'))('esbuild');
const CLX = 'https://w3id.org/cluxel/ontology#';
let names;

before(async () => {
  const made = await build({ entryPoints: [join(web, 'src/sparql/names.ts')], bundle: true, write: false, format: 'esm' });
  names = await import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].contents).toString('base64')}`);
});

const told = (text) => names.namesIn(text).map(({ what, iri }) => `${what} ${iri.replace(CLX, 'clx:')}`);

test('graphs, classes and other names are found, with their prefixes resolved', () => {
  assert.deepEqual(told('ASK { ?s a clx:Tree ; clx:height ?h . <urn:a> ?p 1 }'), ['class clx:Tree', 'name clx:height', 'name urn:a']);
  assert.deepEqual(told('SELECT * FROM <urn:g> FROM NAMED <urn:n> { GRAPH <urn:h> { ?s ?p ?o } }'), ['graph urn:g', 'graph urn:n', 'graph urn:h']);
  assert.deepEqual(told('PREFIX x: <urn:x:> BASE <urn:b>\nASK { ?s x:one ?o FILTER(?o<5&&?o>?s) . ?s x:two.x ?t. ?s x:three ?u.}'),
                   ['name urn:x:one', 'name urn:x:two.x', 'name urn:x:three']);
  assert.deepEqual(told('prefix clx: <urn:own#> ASK { ?s a clx:Tree }'), ['class urn:own#Tree']);
  assert.deepEqual(told('ASK { ?s clx:partOf/^clx:near|<urn:p> ?o }'), ['name clx:partOf', 'name clx:near', 'name urn:p']);
});

test('comments, texts, functions, datatypes, blank nodes, relative IRIs and templates hold no names of the map', () => {
  for (const text of ['ASK { } # clx:Tree', 'ASK { ?s ?p "clx:Tree", \'<urn:a>\', """x "clx:Tree" y""" }', 'ASK { ?s ?p "5"^^xsd:byte }',
                      'ASK { FILTER(geof:distance(?a, ?b) < 1) }', 'ASK { _:b0 ?p _:clx }', 'ASK { <rel> ?p ?o }',
                      'CONSTRUCT { ?s a clx:Mine { } } WHERE { ?s ?p ?o }'])
    assert.deepEqual(told(text), [], text);
  assert.deepEqual(told('CONSTRUCT { ?s a clx:Mine } WHERE { ?s a clx:Tree }'), ['class clx:Tree']);
  assert.deepEqual(told('# clx:Not\nASK { ?s a clx:Tree # clx:Not\n }'), ['class clx:Tree']);
  assert.deepEqual(told('CONSTRUCT WHERE { ?s a clx:Tree }'), ['class clx:Tree']);
});

test('variables that stand in expressions alone have no value', () => {
  const question = readFileSync(join(process.env.CLUXEL_SOURCE, 'queries/near_point.rq'), 'utf8');
  assert.deepEqual(names.unboundIn(question), ['x', 'y', 'radius']);
  assert.deepEqual(names.unboundIn('SELECT (SUM(?o + ?n) AS ?sum) { ?s ?p ?o } HAVING(?sum > 1)'), ['n']);
  assert.deepEqual(names.unboundIn('ASK { ?s ?p ?o FILTER regex(?t, "a") FILTER(EXISTS { ?s ?q ?r } && ?r > ?o) }'), ['t']);
  for (const text of ['ASK { VALUES (?x ?y) { (1 2) } FILTER(?x < ?y) }', 'ASK { ?s clx:p (?a ?b) FILTER(?a < ?b) }', 'ASK { BIND(1 AS ?x) FILTER(?x > 0) }',
                      'ASK { FILTER(!BOUND(?x) && COALESCE(?y, 1) = 1) }', 'SELECT ?c (COUNT(?s) AS ?n) { ?s a ?c } GROUP BY ?c ORDER BY DESC(?n)'])
    assert.deepEqual(names.unboundIn(text), [], text);
});

test('known prefixes that a query does not declare are declared for it', () => {
  assert.equal(names.missingPrefixes('ASK { ?s a clx:Tree ; clx:height ?h ; my:own 1 }'), `PREFIX clx: <${CLX}> `);
  assert.equal(names.missingPrefixes(`PREFIX clx: <${CLX}> ASK { ?s a clx:Tree }`), '');
  assert.deepEqual(names.undeclaredPrefix('ASK {\n ?s clx:height ?h ;\n   my:own 1 }'), { prefix: 'my', line: 3, column: 4 });
  assert.equal(names.undeclaredPrefix('PREFIX my: <urn:> ASK { ?s my:own 1 }'), undefined);
});

test('the nearest name is offered when it is near', () => {
  assert.equal(names.nearest('clx:heigth', ['clx:length', 'clx:height', 'clx:weight']), 'clx:height');
  assert.equal(names.nearest('clx:Tre', ['clx:Tree', 'clx:Terrain']), 'clx:Tree');
  assert.equal(names.nearest('clx:Spaceship', ['clx:Tree', 'clx:StreetSign']), undefined);
});
