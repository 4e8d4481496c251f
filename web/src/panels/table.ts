// SPDX-License-Identifier: Apache-2.0
// The rows of an answer. A row and the object that it names are one selection.
import { capitalised, localName, type MapModel, type MapObject, type Question } from '../data/model';
import { counted, el, rounded, swatch } from '../dom';
import type { RdfTerm, Rows } from '../sparql/answers';
import { shortened } from './editor';

const ROWS_AT_ONCE = 200;
const NUMERIC = /#(integer|decimal|double|float|int|long|nonNegativeInteger)$/;

/** What rows name: parts, observations and primitives stand for their object, a class for its objects. */
export class RowObjects {
  private readonly owners: Map<string, string>;

  constructor(private readonly model: MapModel, owners: Map<string, string>) {
    this.owners = owners;
  }

  private objectOfTerm(term: RdfTerm | null): MapObject | undefined {
    if (term?.kind !== 'iri') return undefined;
    return this.model.objectOf(term.value) ?? this.model.objectOf(this.owners.get(term.value) ?? '');
  }

  ofRow(row: (RdfTerm | null)[]): MapObject[] {
    for (const term of row) {
      const object = this.objectOfTerm(term);
      if (object) return [object];
    }
    for (const term of row)
      if (term?.kind === 'iri' && this.model.classes.has(term.value)) {
        const objects = this.model.objectsOfClass(term.value);
        if (objects.length > 0) return objects;
      }
    return [];
  }
}

export interface TableEvents { choose(objects: MapObject[], row: number): void }

export class AnswerTable {
  readonly element = el('div', { class: 'answer' });
  private body = el('tbody');
  private objectsOfRow: MapObject[][] = [];
  /** Rows with a place of their own. */
  private isPlaced: boolean[] = [];

  constructor(private readonly model: MapModel, private readonly events: TableEvents) {}

  show(answer: Rows, question: Question | undefined, objectsOfRow: MapObject[][],
       isPlaced: boolean[] = []): void {
    this.objectsOfRow = objectsOfRow;
    this.isPlaced = isPlaced;
    this.body = el('tbody');
    const heads = answer.variables.map((name) => {
      const column = question?.columns.find((candidate) => candidate.name === name);
      const unit = column && !['IRI', 'text', '1'].includes(column.unit) ? ` [${column.unit}]` : '';
      return el('th', { scope: 'col', title: column?.help || undefined }, name, unit && el('small', {}, unit));
    });
    const table = el('table', {}, el('thead', {}, el('tr', {}, el('th', { scope: 'col', class: 'rank' }, '#'), ...heads)),
                     this.body);
    const more = el('button', { type: 'button', class: 'plain', onclick: () => add() }, 'Show more rows');
    let shown = 0;
    const add = () => {
      const until = Math.min(answer.rows.length, shown + ROWS_AT_ONCE);
      for (; shown < until; ++shown) this.body.append(this.rowOf(answer.rows[shown], shown));
      more.hidden = shown >= answer.rows.length;
      more.textContent = `Show more rows (${counted(answer.rows.length - shown)} left)`;
    };
    add();
    this.element.replaceChildren(el('div', { class: 'table-scroll' }, table), more);
  }

  clear(): void {
    this.element.replaceChildren();
  }

  /** Marks the rows of the selected object. */
  mark(object: MapObject | null): void {
    [...this.body.rows].forEach((row, i) => {
      const isMarked = object !== null && this.objectsOfRow[i].length === 1 && this.objectsOfRow[i][0] === object;
      row.setAttribute('aria-selected', String(isMarked));
      if (isMarked) row.scrollIntoView({ block: 'nearest' });
    });
  }

  private rowOf(cells: (RdfTerm | null)[], number: number): HTMLTableRowElement {
    const objects = this.objectsOfRow[number], choose = () => this.events.choose(objects, number);
    const isLive = objects.length > 0 || Boolean(this.isPlaced[number]);
    return el('tr', {
      class: isLive ? 'live' : 'still', tabindex: isLive ? 0 : undefined, 'aria-selected': 'false',
      title: isLive ? undefined : 'This row names nothing that has a place in the map.',
      onclick: isLive ? choose : undefined,
      onkeydown: isLive ? (event: KeyboardEvent) => this.keyInRow(event, choose) : undefined,
    }, el('td', { class: 'rank' }, String(number + 1)), ...cells.map((term) => this.cellOf(term)));
  }

  private keyInRow(event: KeyboardEvent, choose: () => void): void {
    const row = event.currentTarget as HTMLTableRowElement;
    const next = event.key === 'ArrowDown' ? row.nextElementSibling : event.key === 'ArrowUp' ? row.previousElementSibling : null;
    if (next) (next as HTMLElement).focus();
    else if (event.key === 'Enter' || event.key === ' ') choose();
    else return;
    event.preventDefault();
  }

  private cellOf(term: RdfTerm | null): HTMLTableCellElement {
    if (!term) return el('td', { class: 'unbound' }, '–');
    if (term.kind === 'iri') {
      const object = this.model.objectOf(term.value);
      if (object) {
        return el('td', { title: term.value }, swatch(object.class.color || '#808080'), object.id.slice(0, 8));
      }
      const known = this.model.classes.get(term.value);
      return el('td', { title: term.value }, known ? capitalised(known.label) : shortIri(term.value));
    }
    if (term.datatype && NUMERIC.test(term.datatype) && Number.isFinite(Number(term.value)))
      return el('td', { class: 'number', title: term.value }, rounded(Number(term.value)));
    return el('td', { title: term.value.length > 40 ? term.value : undefined }, term.value);
  }
}

function shortIri(iri: string): string {
  const short = shortened(iri);
  return short.length <= 34 ? short : `${localName(iri).slice(0, 16)}…`;
}
