// SPDX-License-Identifier: Apache-2.0
// The names in the text of a query, with their prefixes resolved: what the page checks before it says "0 rows".

/** They need no PREFIX line, as for `cluxel query`. */
const KNOWN: Record<string, string> = {
  clx: 'https://w3id.org/cluxel/ontology#',
  geo: 'http://www.opengis.net/ont/geosparql#',
  geof: 'http://www.opengis.net/def/function/geosparql/',
  sosa: 'http://www.w3.org/ns/sosa/',
  prov: 'http://www.w3.org/ns/prov#',
  rdf: 'http://www.w3.org/1999/02/22-rdf-syntax-ns#',
  rdfs: 'http://www.w3.org/2000/01/rdf-schema#',
  owl: 'http://www.w3.org/2002/07/owl#',
  xsd: 'http://www.w3.org/2001/XMLSchema#',
  skos: 'http://www.w3.org/2004/02/skos/core#',
};

const TOKEN = new RegExp([
  '(?<skipped>#[^\\n]*|_:[\\p{L}\\p{N}_.-]+|"""(?:[^"\\\\]|\\\\.|"(?!""))*"""|' +
    "'''(?:[^'\\\\]|\\\\.|'(?!''))*'''|\"(?:[^\"\\\\\\n]|\\\\.)*\"|'(?:[^'\\\\\\n]|\\\\.)*')",
  '[?$](?<variable>[\\p{L}\\p{N}_]+)',
  '<(?<iri>[^\\s<>"{}|\\\\^`]*)>',
  '(?<prefix>(?:\\p{L}(?:[\\p{L}\\p{N}_.-]*[\\p{L}\\p{N}_-])?)?):(?<local>(?:[\\p{L}\\p{N}_:%]|[.-](?=[\\p{L}\\p{N}_:%.-]))*)',
  '(?<word>[\\p{L}\\p{N}_]+)',
  '(?<sign>\\^\\^|\\S)',
].join('|'), 'gsu');

export interface UnknownName { what: 'graph' | 'class' | 'name'; iri: string }
export interface Token { at: number; end: number; sign?: string; word?: string; variable?: string; iri?: string; prefix?: string; local?: string }

export function tokensOf(text: string): Token[] {
  return [...text.matchAll(TOKEN)].filter((match) => match.groups!.skipped === undefined)
    .map((match) => ({ at: match.index, end: match.index + match[0].length, ...match.groups }));
}

/** Tokens without the lines of PREFIX and BASE, and what these declare. */
export function prologueOf(tokens: Token[]): { rest: Token[]; prefixes: Map<string, string> } {
  const prefixes = new Map<string, string>();
  let at = 0;
  for (;;) {
    const word = tokens[at]?.word?.toUpperCase();
    if (word === 'PREFIX' && tokens[at + 2]?.iri !== undefined) {
      prefixes.set(tokens[at + 1].prefix ?? '', tokens[at + 2].iri!);
      at += 3;
    } else if (word === 'BASE') {
      at += 2;
    } else {
      return { rest: tokens.slice(at), prefixes };
    }
  }
}

/** The IRI that a token names: relative ones as they stand, none for a prefix that nothing declares. */
export function iriOf({ iri, prefix, local }: Token, prefixes: Map<string, string>): string | undefined {
  const namespace = prefix === undefined ? undefined : prefixes.get(prefix) ?? KNOWN[prefix];
  return iri ?? (namespace === undefined ? undefined : namespace + local);
}

/** PREFIX lines, in one line, for the known prefixes that a query uses and does not declare. */
export function missingPrefixes(text: string): string {
  const { rest, prefixes } = prologueOf(tokensOf(text));
  const used = new Set(rest.map((token) => token.prefix).filter((prefix) => prefix !== undefined));
  return [...used].filter((prefix) => prefix in KNOWN && !prefixes.has(prefix))
    .map((prefix) => `PREFIX ${prefix}: <${KNOWN[prefix]}> `).join('');
}

/** The first prefix that nothing declares, and where it stands: line and column from 1. */
export function undeclaredPrefix(text: string): { prefix: string; line: number; column: number } | undefined {
  const { rest, prefixes } = prologueOf(tokensOf(text));
  const token = rest.find(({ prefix }) => prefix !== undefined && !(prefix in KNOWN) && !prefixes.has(prefix));
  if (!token) return undefined;
  const before = text.slice(0, token.at).split('\n');
  return { prefix: token.prefix!, line: before.length, column: before[before.length - 1].length + 1 };
}

/** What a template makes need not be in the map. */
function withoutTemplate(tokens: Token[]): Token[] {
  const begin = tokens.findIndex(({ word }) => word?.toUpperCase() === 'CONSTRUCT') + 1;
  if (begin === 0 || tokens[begin]?.sign !== '{') return tokens;
  let depth = 0;
  const end = tokens.findIndex(({ sign }, i) => i >= begin && (depth += sign === '{' ? 1 : sign === '}' ? -1 : 0) === 0);
  return end < 0 ? tokens : [...tokens.slice(0, begin), ...tokens.slice(end + 1)];
}

/** Graphs, classes and other names that a query asks for, each once; no functions, datatypes and relative IRIs. */
export function namesIn(text: string): UnknownName[] {
  const { rest, prefixes } = prologueOf(tokensOf(text)), tokens = withoutTemplate(rest);
  const found = new Map<string, UnknownName>();
  tokens.forEach((token, i) => {
    const iri = iriOf(token, prefixes);
    const before = tokens[i - 1], word = before?.word;
    if (!iri || !/^[a-z][a-z0-9+.-]*:/i.test(iri) || before?.sign === '^^' || tokens[i + 1]?.sign === '(') return;
    const what = /^(from|named|graph)$/i.test(word ?? '') ? 'graph' : word === 'a' ? 'class' : 'name';
    if (!found.has(iri)) found.set(iri, { what, iri });
  });
  return [...found.values()];
}

/**
 * Variables that stand in expressions alone, so that they have no value, as the parameters of a shipped question that is
 * asked as it stands. Where an expression cannot be told from a pattern, a variable counts as bound.
 */
export function unboundIn(text: string): string[] {
  const { rest: tokens } = prologueOf(tokensOf(text)), opened: string[] = [], bound = new Set<string>(), used = new Set<string>();
  tokens.forEach(({ sign, variable }, i) => {
    const before = tokens[i - 1], top = opened[opened.length - 1] ?? '{';
    if (sign === '{') opened.push('{');
    else if (sign === '(') opened.push(before?.word?.toUpperCase() ?? (top === '{' ? '{' : 'EXPRESSION'));
    else if (sign === ')' || sign === '}') opened.pop();
    if (variable === undefined) return;
    if (top === '{' || top === 'VALUES' || before?.word?.toUpperCase() === 'AS') bound.add(variable);
    else if (top !== 'BOUND' && top !== 'COALESCE') used.add(variable);
  });
  return [...used].filter((name) => !bound.has(name));
}

/** The candidate that differs least; at most every third letter may differ. */
export function nearest(name: string, candidates: string[]): string | undefined {
  let best: string | undefined, least = Math.floor(name.length / 3) + 1;
  for (const candidate of candidates) {
    if (Math.abs(candidate.length - name.length) >= least) continue;
    const distance = editDistance(name.toLowerCase(), candidate.toLowerCase());
    if (distance < least) [best, least] = [candidate, distance];
  }
  return best;
}

/** Letters that are changed, left out, added, or swapped with the next one. */
function editDistance(a: string, b: string): number {
  const rows = [Array.from({ length: b.length + 1 }, (_, j) => j)];
  for (let i = 1; i <= a.length; ++i) {
    rows.push([i]);
    for (let j = 1; j <= b.length; ++j) {
      const isSwapped = i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1];
      rows[i].push(Math.min(rows[i - 1][j] + 1, rows[i][j - 1] + 1, rows[i - 1][j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1),
                            isSwapped ? rows[i - 2][j - 2] + 1 : Infinity));
    }
  }
  return rows[a.length][b.length];
}
