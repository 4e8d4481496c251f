// SPDX-License-Identifier: Apache-2.0
// STR and GROUP_CONCAT as `cluxel query` answers them. The engine keeps times and decimals by their value and makes the
// shortest text of them, and it refuses to join what is no string. Such calls are written anew for it.
import { iriOf, prologueOf, tokensOf, type Token } from './names';

const XSD = 'http://www.w3.org/2001/XMLSchema#';
/** Texts of the engine for times in UTC that Cluxel writes with six digits after the point. */
const SHORT_TIME = '^[0-9]+-[0-9][0-9]-[0-9][0-9]T[0-9:]+([.][0-9]{1,5})?Z$';
/** These hand on one of their values as it is stored. */
const HANDS_ON = /^(MIN|MAX|SAMPLE|COALESCE|DISTINCT)$/i;
/** What these make is neither a time nor a number with a point: texts, IRIs, truth values, whole numbers. */
const MAKES_TEXT = new RegExp('^(STR|CONCAT|GROUP_CONCAT|SUBSTR|UCASE|LCASE|REPLACE|STRBEFORE|STRAFTER|ENCODE_FOR_URI|LANG|DATATYPE|' +
  'IRI|URI|MD5|SHA1|SHA256|SHA384|SHA512|UUID|STRUUID|STRLANG|TZ|BOUND|CONTAINS|STRSTARTS|STRENDS|REGEX|LANGMATCHES|SAMETERM|' +
  'ISIRI|ISURI|ISBLANK|ISLITERAL|ISNUMERIC|COUNT|STRLEN|YEAR|MONTH|DAY|HOURS|MINUTES)$', 'i');
/** The engine tells these as they are written. */
const PLAIN_WORD = /^(0|[1-9]\d{0,17}|true|false|UNDEF|DISTINCT)$/i;

/** The time as Cluxel writes it, in SPARQL, from an expression for such a text. */
const fullTimeOf = (text: string) =>
  `CONCAT(REPLACE(${text}, "([.].*)?Z$", ""), ".", SUBSTR(CONCAT(STRBEFORE(STRAFTER(${text}, "."), "Z"), "000000"), 1, 6), "Z")`;

/** A value is written several times, so that calls within calls grow: longer ones stay as they are. */
const LONGEST = 20_000;

export interface Rewritten {
  text: string;
  /** Whether a call makes text of a value. */
  makesText: boolean;
  /** Whether times and numbers in such a text may be written otherwise: not all values surely come from the map. */
  isDoubtful: boolean;
  /** Whether texts are joined DISTINCT that are no texts before: here each text counts once, there each value. */
  joinsDistinct: boolean;
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
  /** Variables to which VALUES gives values that the query writes, and that are no plain texts, IRIs or whole numbers. */
  private readonly writtenOut = new Set<string>();
  private makesText = false;
  private isDoubtful = false;
  private joinsDistinct = false;
  private isWhole = true;

  constructor(private readonly text: string) {
    const { rest, prefixes } = prologueOf(tokensOf(text));
    this.tokens = rest;
    this.prefixes = prefixes;
    const opened: number[] = [];
    rest.forEach(({ sign, word }, i) => {
      if (word?.toUpperCase() === 'VALUES') this.readValues(i + 1);
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
    const { makesText, isDoubtful, joinsDistinct, isWhole } = this;
    return { text: this.text.slice(0, begin) + body, makesText, isDoubtful, joinsDistinct, isWhole };
  }

  /** Reads the variables and the block of VALUES. */
  private readValues(begin: number): void {
    const open = this.tokens.findIndex(({ sign }, i) => i >= begin && sign === '{');
    const close = this.tokens.findIndex(({ sign }, i) => i > open && sign === '}');
    if (open < 0 || this.arePlain(open + 1, close)) return;
    for (const { variable } of this.tokens.slice(begin, open)) if (variable !== undefined) this.writtenOut.add(variable);
  }

  /** Whether a block of VALUES has texts, IRIs and whole numbers alone. Quoted texts are no tokens. */
  private arePlain(first: number, last: number): boolean {
    return this.tokens.slice(first, last).every(({ sign, word }, i, block) =>
      word !== undefined ? PLAIN_WORD.test(word) || block[i - 1]?.sign === '@' : sign === undefined || '()@'.includes(sign));
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
    if (isDistinct && !this.isText(first, last)) this.joinsDistinct = true;
    const begin = this.tokens[first - 1].end, end = this.tokens[last].at;
    return this.text.slice(this.tokens[i].at, begin) + ` ${this.textOf(first, last, begin, end, true)}` + this.text.slice(end, this.tokens[close].end);
  }

  /** Whether the expression is a single call that makes text. */
  private isText(first: number, last: number): boolean {
    const makesText = this.callAt(first) !== undefined || /^CONCAT$/i.test(this.tokens[first]?.word ?? '');
    return makesText && this.closeOf(first + 1, last) === last - 1;
  }

  /**
   * The text of an expression: the stored one where all values are of the map, the engine's with a doubt otherwise. Casts
   * of decimals give the shortest text in `cluxel query`, too.
   */
  private textOf(first: number, last: number, at: number, end: number, keepsDecimals: boolean): string {
    this.makesText = true;
    const value = this.written(first, last, at, end), text = `STR(${value})`;
    if (this.callAt(first) !== undefined && this.closeOf(first + 1, last) === last - 1) return value;  // it is text already
    if (!this.isSure(first, last, [])) {
      this.isDoubtful = true;
      return text;
    }
    if (value.length > LONGEST) {
      this.isWhole = false;
      return text;
    }
    const is = (type: string) => `isLiteral(${value}) && DATATYPE(${value}) = <${XSD}${type}>`;
    const other = keepsDecimals ? `IF(${is('decimal')} && !CONTAINS(${text}, "."), CONCAT(${text}, ".0"), ${text})` : text;
    return `IF(${is('dateTime')} && REGEX(${text}, "${SHORT_TIME}"), ${fullTimeOf(text)}, ${other})`;
  }

  /** Whether each time and number among the values is one that the map has: of a variable that patterns alone bind. */
  private isSure(first: number, last: number, within: string[]): boolean {
    for (let i = first; i < last; ++i) {
      const { sign, word, variable } = this.tokens[i], isCall = this.tokens[i + 1]?.sign === '(';
      if (variable !== undefined) {
        if (!this.isOfMap(variable, within)) return false;
      } else if (isCall && (this.callAt(i) !== undefined || MAKES_TEXT.test(word ?? ''))) {
        const close = this.closeOf(i + 1, last);
        if (close < 0) return false;
        i = close;
      } else if (word !== undefined) {
        if (!(isCall ? HANDS_ON : PLAIN_WORD).test(word)) return false;
      } else if (sign !== undefined ? !'(),'.includes(sign) : isCall) {
        return false;
      }
    }
    return true;
  }

  private isOfMap(variable: string, within: string[]): boolean {
    const expressions = this.computed.get(variable) ?? [];
    return !within.includes(variable) && !this.writtenOut.has(variable) &&
      expressions.every(([begin, end]) => this.isSure(begin, end, [...within, variable]));
  }
}

/**
 * Whether the query may read values of these properties: it names one, or a variable or a negated path stands for a
 * property, such as in `?o ?p ?v`.
 */
export function readsAnyOf(properties: Set<string>, text: string): boolean {
  if (properties.size === 0) return false;
  const { rest, prefixes } = prologueOf(tokensOf(text)), opened: string[] = [];
  return rest.some((token, i) => {
    const { sign, variable } = token, next = rest[i + 1];
    if (sign && '({'.includes(sign)) opened.push(sign);
    else if (sign && ')}'.includes(sign)) opened.pop();
    if (properties.has(iriOf(token, prefixes) ?? '')) return true;
    if (sign === '!') return (next !== undefined && iriOf(next, prefixes) !== undefined) || next?.word === 'a' || ['(', '^'].includes(next?.sign ?? '');
    return opened.at(-1) === '{' && variable !== undefined && (next?.variable !== undefined || next?.sign === '[');
  });
}
