// SPDX-License-Identifier: Apache-2.0
// The forms of times and numbers that the page's engine keeps the text of. This needs no browser.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { before, test } from 'node:test';

const web = join(process.env.CLUXEL_SOURCE, 'web'), { build } = createRequire(join(web, 'build.mjs'))('esbuild');
const loaded = async (file) => {
  const made = await build({ entryPoints: [join(web, 'src/sparql', file)], bundle: true, write: false, format: 'esm' });
  return import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].contents).toString('base64')}`);
};
let forms, texts;

before(async () => {
  forms = await loaded('checked_forms.ts');
  texts = await loaded('stored_text.ts');
});

const typed = (text, type) => `"${text}"^^<http://www.w3.org/2001/XMLSchema#${type}>`;

test('numbers and times as Cluxel writes them are checked, others are not', () => {
  const checked = [['0', 'integer'], ['-12', 'integer'], ['2.0', 'decimal'], ['-0.25', 'decimal'], ['true', 'boolean'],
                   ['2023-11-15T22:13:20.000000Z', 'dateTime'], ['a', 'string']].map(([text, type]) => typed(text, type));
  const other = [['007', 'integer'], ['+1', 'integer'], ['-0', 'integer'], ['1.50', 'decimal'], ['2', 'decimal'], ['.5', 'decimal'], ['-0.0', 'decimal'],
                 ['0.1234567890123456789', 'decimal'], ['1', 'boolean'], ['5.0E-1', 'double'], ['1', 'int'], ['PT60S', 'duration'],
                 ['2023-11-15T22:13:20Z', 'dateTime'], ['2023-11-15T22:13:20.000000+01:00', 'dateTime']].map(([text, type]) => typed(text, type));
  for (const term of [...checked, '<urn:a>', '_:b', '"1.50"', '"a"@en', '"1.50"^^<urn:type>']) assert.ok(forms.hasCheckedForm(term), term);
  for (const term of other) assert.ok(!forms.hasCheckedForm(term), term);
});

test('the properties are those that have such a value', () => {
  const terms = ['<urn:g>', '<urn:s>', '<urn:p>', '<urn:q>', typed('1.50', 'decimal'), typed('2.0', 'decimal')].join('\n');
  const quads = new Uint8Array([0, 2, 1, 2, 4, 0, 3, 5, 0, 1, 1, 3, 5]);
  assert.deepEqual([...forms.uncheckedProperties(terms, quads)], ['urn:p']);
});

test('a query reads a property that it names, and all by a variable or a negated path', () => {
  const reads = (text) => texts.readsAnyOf(new Set(['urn:p']), text);
  for (const text of ['ASK { ?s <urn:p> ?v }', 'PREFIX u: <urn:> ASK { ?s <urn:q>/u:p ?v }', 'ASK { ?s ?p ?v }', 'ASK { ?s <urn:q> 1 ; ?p ?v }',
                      'ASK { ?s !<urn:q> ?v }', 'ASK { ?s !(a|<urn:q>) ?v }', 'ASK { _:b ?p ?v }', 'SELECT * { GRAPH ?g { <urn:s> ?p ?v } }', 'ASK { ?s ?p [ <urn:q> ?v ] }'])
    assert.ok(reads(text), text);
  for (const text of ['ASK { ?s <urn:q> ?v }', 'SELECT ?s ?v { ?s <urn:q> ?v FILTER(!isBlank(?v)) } ORDER BY ?s ?v', 'ASK { GRAPH ?g { ?s <urn:q> ?v . ?v <urn:q> ?w } }'])
    assert.ok(!reads(text), text);
  assert.ok(!texts.readsAnyOf(new Set(), 'ASK { ?s ?p ?v }'));
});
