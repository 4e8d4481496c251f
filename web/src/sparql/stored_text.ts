// SPDX-License-Identifier: Apache-2.0
// STR and GROUP_CONCAT as `cluxel query` answers them. The engine keeps times and decimals by their value and makes the
// shortest text of them, and it refuses to join what is no string. Such calls are written anew for it.
import { iriOf, prologueOf, tokensOf, type Token } from './names';

const XSD = 'http://www.w3.org/2001/XMLSchema#';
/** Texts of the engine for times in UTC that Cluxel writes with six digits after the point. */
const SHORT_TIME = '^[0-9]+-[0-9][0-9]-[0-9][0-9]T[0-9:]+([.][0-9]{1,5})?Z$';
/** These hand on one of their values as it is stored; other functions and signs make a new one. */
const HANDS_ON = /^(MIN|MAX|SAMPLE|COALESCE|DISTINCT)$/i;
const MAY_HAND_ON = /^(MIN|MAX|SAMPLE|COALESCE|IF)$/i;

/** The time as Cluxel writes it, in SPARQL, from an expression for such a text. */
const fullTimeOf = (text: string) =>
  `CONCAT(REPLACE(${text}, "([.].*)?Z$", ""), ".", SUBSTR(CONCAT(STRBEFORE(STRAFTER(${text}, "."), "Z"), "000000"), 1, 6), "Z")`;

/** A value is written several times, so that calls within calls grow: longer ones stay as they are. */
const LONGEST = 20_000;

export interface Rewritten {
  text: string;
  /** Whether a call makes text of a value. */
  makesText: boolean;
  /** Whether numbers in such a text may be written otherwise: it cannot be told if they are stored or computed. */
  isDoubtful: boolean;
  /** Whether all calls are written anew. */
  isWhole: boolean;
}

/** A query whose calls of STR, xsd:string and GROUP_CONCAT give the text that the map has. */
export function withStoredText(text: string): Rewritten {
  return new Rewriting(text).done();
}

class Rewriting {
  private readonly tokens: Token[];
  private readonly prefixes: Map<string, string>;
  /** By variable the expressions that AS gives it, as ranges of tokens. */
  private readonly computed = new Map<string, [number, number][]>();
  private makesText = false;
  private isDoubtful = false;
  private isWhole = true;

  constructor(private readonly text: string) {
    const { rest, prefixes } = prologueOf(tokensOf(text));
    this.tokens = rest;
    this.prefixes = prefixes;
    const opened: number[] = [];
    rest.forEach(({ sign, word }, i) => {
      if (sign === '(') opened.push(i);
      else if (sign === ')') opened.pop();
      const variable = rest[i + 1]?.variable, begin = opened[opened.length - 1];
      if (word?.toUpperCase() !== 'AS' || variable === undefined || begin === undefined) return;
      this.computed.set(variable, [...(this.computed.get(variable) ?? []), [begin + 1, i]]);
    });
  }

  done(): Rewritten {
    const begin = this.tokens[0]?.at ?? this.text.length;
    const body = this.written(0, this.tokens.length, begin, this.text.length);
    const { makesText, isDoubtful, isWhole } = this;
    return { text: this.text.slice(0, begin) + body, makesText, isDoubtful, isWhole };
  }

  /** The text from `at` to `end`, which has the tokens from `first` to before `last`. */
  private written(first: number, last: number, at: number, end: number): string {
    let made = '';
    for (let i = first; i < last; ++i) {
      const name = this.callAt(i), close = name === undefined ? -1 : this.closeOf(i + 1, last);
      if (close < 0) continue;
      made += this.text.slice(at, this.tokens[i].at) + this.call(name!, i, close);
      at = this.tokens[close].end;
      i = close;
    }
    return made + this.text.slice(at, end);
  }

  private callAt(i: number): 'STR' | 'GROUP_CONCAT' | 'CAST' | undefined {
    if (this.tokens[i + 1]?.sign !== '(') return undefined;
    const word = this.tokens[i].word?.toUpperCase();
    if (word === 'STR' || word === 'GROUP_CONCAT') return word;
    return iriOf(this.tokens[i], this.prefixes) === `${XSD}string` && this.tokens[i - 1]?.sign !== '^^' ? 'CAST' : undefined;
  }

  /** The token that closes the bracket at `open`; less than 0 when none does. */
  private closeOf(open: number, last: number): number {
    let depth = 0;
    return this.tokens.findIndex(({ sign }, i) => i >= open && i < last && (depth += sign === '(' ? 1 : sign === ')' ? -1 : 0) === 0);
  }

  private call(name: 'STR' | 'GROUP_CONCAT' | 'CAST', i: number, close: number): string {
    if (name !== 'GROUP_CONCAT') return this.textOf(i + 2, close, this.tokens[i + 1].end, this.tokens[close].at, name === 'STR');
    const isDistinct = this.tokens[i + 2].word?.toUpperCase() === 'DISTINCT', first = i + (isDistinct ? 3 : 2);
    let depth = 0, last = first;
    for (; last < close; ++last) {
      const { sign } = this.tokens[last];
      depth += sign && '({'.includes(sign) ? 1 : sign && ')}'.includes(sign) ? -1 : 0;
      if (depth === 0 && sign === ';') break;
    }
    const begin = this.tokens[first - 1].end, end = this.tokens[last].at;
    return this.text.slice(this.tokens[i].at, begin) + ` ${this.textOf(first, last, begin, end, true)}` + this.text.slice(end, this.tokens[close].end);
  }

  /** The stored text of an expression. Casts of decimals give the shortest text in `cluxel query`, too. */
  private textOf(first: number, last: number, at: number, end: number, keepsDecimals: boolean): string {
    this.makesText = true;
    const value = this.written(first, last, at, end), text = `STR(${value})`;
    if (this.callAt(first) !== undefined && this.closeOf(first + 1, last) === last - 1) return value;  // it is text already
    if (value.length > LONGEST) {
      this.isWhole = false;
      return text;
    }
    const is = (type: string) => `isLiteral(${value}) && DATATYPE(${value}) = <${XSD}${type}>`;
    const isStored = keepsDecimals && this.isStored(first, last, []);
    if (keepsDecimals && !isStored && this.mayHandOn(first, last, [])) this.isDoubtful = true;
    const other = isStored ? `IF(${is('decimal')} && !CONTAINS(${text}, "."), CONCAT(${text}, ".0"), ${text})` : text;
    return `IF(${is('dateTime')} && REGEX(${text}, "${SHORT_TIME}"), ${fullTimeOf(text)}, ${other})`;
  }

  /** Whether the value is one that the map has: of a variable that patterns bind. */
  private isStored(first: number, last: number, within: string[]): boolean {
    return this.tokens.slice(first, last).every(({ sign, word, variable }) => {
      if (variable === undefined) return word !== undefined ? HANDS_ON.test(word) : sign !== undefined && '(),'.includes(sign);
      const expressions = this.computed.get(variable) ?? [];
      return !within.includes(variable) && expressions.every(([begin, end]) => this.isStored(begin, end, [...within, variable]));
    });
  }

  /** Whether the value may be one that the map has, or is a double, of which the engine makes another text. */
  private mayHandOn(first: number, last: number, within: string[]): boolean {
    return this.tokens.slice(first, last).some((token) => {
      if (token.variable === undefined)
        return MAY_HAND_ON.test(token.word ?? '') || [`${XSD}double`, `${XSD}float`].includes(iriOf(token, this.prefixes) ?? '');
      const expressions = within.includes(token.variable) ? [] : this.computed.get(token.variable) ?? [];
      return expressions.some(([begin, end]) => this.mayHandOn(begin, end, [...within, token.variable!]));
    });
  }
}
