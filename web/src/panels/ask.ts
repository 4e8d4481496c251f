// SPDX-License-Identifier: Apache-2.0
// The panel of questions: choose a shipped one or write SPARQL, run it, see rows, light up objects, take the answer away.
import type { Address, AddressQuestion } from '../address';
import { capitalised, type MapModel, type MapObject, type Question } from '../data/model';
import { counted, el, icon, messageOf } from '../dom';
import { csvOf, geoJsonOf, save } from '../downloads';
import type { Place, Places } from '../data/places';
import type { Stage } from '../scene/stage';
import type { Answer, RdfTerm, Rows } from '../sparql/answers';
import type { Engine } from '../sparql/engine';
import { nearest } from '../sparql/names';
import { bodyOf, withValues } from '../sparql/questions';
import type { Store } from '../state';
import { Editor, shortened } from './editor';
import { middleOfPlace } from './places';
import { AnswerTable, RowObjects } from './table';

const OWNERS = `PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX sosa: <http://www.w3.org/ns/sosa/>
SELECT ?part ?object { ?part clx:partOf|clx:primitiveOf|sosa:hasFeatureOfInterest ?object }`;
const HISTORY = 'https://w3id.org/cluxel/graph/history';
const DOUBTS = {
  texts: 'Times and numbers as text may be written otherwise, such as 2 for 2.0: cluxel query tells them as they are written.',
  joined: 'GROUP_CONCAT(DISTINCT …) joins the same text once here; cluxel query joins it once for each value, such as 2 and "2". Write DISTINCT STR(…) for the same in both.',
};
const RANKED = /\bORDER\s+BY\b/i;

export class AskPanel {
  readonly element: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly parameters = el('div', { class: 'parameters' });
  private readonly run = el('button', { type: 'button', class: 'primary', onclick: () => this.ask() }, icon('run'), 'Ask');
  private readonly stop = el('button', { type: 'button', hidden: true, onclick: () => void this.engine.stop() }, icon('stop'), 'Stop');
  private readonly status = el('p', { class: 'status', role: 'status' });
  private readonly actions = el('div', { class: 'actions', hidden: true });
  private readonly ideas = el('div', { class: 'ideas' });
  private readonly editor: Editor;
  private readonly table: AnswerTable;
  private owners: Map<string, string> | undefined;
  private isWriting = false;
  private placesOfRow: (Place | undefined)[] = [];

  constructor(private readonly model: MapModel, private readonly engine: Engine, private readonly store: Store,
              private readonly address: Address, private readonly places: Places,
              private readonly stage: Stage) {
    const { questions } = model.values;
    this.select = el('select', { id: 'question', onchange: () => this.choose(this.question) },
                     ...questions.map((question) => el('option', { value: question.file }, question.title || question.file)),
                     el('option', { value: '' }, 'A question of your own'));
    const host = el('div', { class: 'editor' });
    this.table = new AnswerTable(model, { choose: (objects, row) => this.chooseRow(objects, this.placesOfRow[row]) });
    this.element = el('section', { class: 'ask', 'aria-label': 'Questions' },
                      el('label', { for: 'question', class: 'label' }, 'Question'), this.select, this.parameters,
                      el('details', { class: 'sparql', ontoggle: () => this.editor.refresh() }, el('summary', {}, 'SPARQL'), host),
                      el('div', { class: 'row' }, this.run, this.stop, el('kbd', {}, 'Ctrl Enter')),
                      this.status, this.actions, this.ideas, this.table.element);
    this.ideas.append(el('p', { class: 'label' }, 'Questions that come with Cluxel'), ...questions.map((question) =>
      el('button', { type: 'button', onclick: () => void this.askNamed(question.file) }, question.title || question.file)));
    this.editor = new Editor(host, model, () => this.ask(), () => this.edited());
    store.on(['selected'], (state) => this.table.mark(state.selected));
  }

  /** Shows the question that the address names, and asks it; else the first one, unasked. */
  restore(question: AddressQuestion): void {
    const known = this.model.values.questions.find((candidate) => candidate.file === question.file);
    if (known || !question.text) this.select.value = (known ?? this.model.values.questions[0])?.file ?? '';
    else this.select.value = '';
    if (question.text) this.write(question.text);
    else this.choose(this.question, false);
    if (question.text || known) void this.ask();
  }

  /** Asks a question by the name of its file, as a button elsewhere on the page does. */
  askNamed(file: string): Promise<void> {
    this.select.value = file;
    this.choose(this.question, false);
    return this.ask();
  }

  focus(): void {
    this.select.focus();
  }

  private get question(): Question | undefined {
    return this.model.values.questions.find((candidate) => candidate.file === this.select.value);
  }

  private choose(question: Question | undefined, toAsk = true): void {
    this.parameters.replaceChildren(...(question?.parameters ?? []).map((parameter) => {
      const id = `parameter-${parameter.name}`;
      return el('div', { class: 'field' },
                el('label', { for: id, title: parameter.help },
                   `${capitalised(parameter.name)}${parameter.unit === '1' ? '' : ` [${parameter.unit}]`}`),
                el('input', { id, name: parameter.name, value: parameter.value, autocomplete: 'off', title: parameter.help,
                              oninput: () => this.write(this.textWithValues()),
                              onkeydown: (event: KeyboardEvent) => { if (event.key === 'Enter') void this.ask(); } }));
    }));
    if (question) this.write(this.textWithValues());
    else (this.element.querySelector('details') as HTMLDetailsElement).open = true;
    if (toAsk && question) void this.ask();
  }

  private textWithValues(): string {
    const question = this.question;
    if (!question) return this.editor.text;
    const inputs = [...this.parameters.querySelectorAll('input')];
    return withValues(question, new Map(inputs.map((input) => [input.name, input.value])));
  }

  private write(text: string): void {
    this.isWriting = true;
    this.editor.text = text;
    this.isWriting = false;
  }

  /** A changed text is no longer the shipped question. */
  private edited(): void {
    if (this.isWriting || !this.question || this.editor.text === bodyOf(this.question)) return;
    this.select.value = '';
    this.parameters.replaceChildren();
  }

  private async ask(): Promise<void> {
    const question = this.question, text = this.editor.text;
    this.address.setQuestion(question && question.parameters.length === 0 ? { file: question.file } : { text });
    this.busy(true);
    this.status.textContent = this.owners ? 'Asking…' : 'Loading the map into the SPARQL engine…';
    try {
      this.owners ??= await this.readOwners();
      const answer = await this.engine.ask(text);
      this.show(answer, question, await this.places.all());
    } catch (fault) {
      this.showEngineFault(messageOf(fault));
    }
    this.busy(false);
  }

  private busy(on: boolean): void {
    this.run.disabled = on;
    this.ideas.hidden = true;
    this.stop.hidden = !on;
    this.element.setAttribute('aria-busy', String(on));
    this.status.classList.remove('fault');
  }

  private async readOwners(): Promise<Map<string, string>> {
    const answer = (await this.engine.ask(OWNERS)) as Rows;
    return new Map(answer.rows.map((row) => [row[0]!.value, row[1]!.value]));
  }

  /** A fault of the engine, with the place in the question. */
  private showEngineFault(message: string): void {
    const place = /^error at (\d+):(\d+): (.*)$/s.exec(message);
    if (!place) return this.showFault(message);
    this.editor.pointTo(Number(place[1]), Number(place[2]));
    // The engine lists some of what it expects, in a notation of its own, which leads people astray.
    const detail = place[3].startsWith('expected') ? 'cluxel query --check tells what is missing or too much' : place[3];
    this.showFault(`Line ${place[1]}, column ${place[2]}: the question cannot be read here: ${detail}.`);
  }

  private showFault(message: string): void {
    this.store.set('lit', null);
    this.table.clear();
    this.actions.hidden = true;
    this.status.textContent = message;
    queueMicrotask(() => this.status.classList.add('fault'));
  }

  /** Warnings about names that are not in the page, variables without a value, and texts that the engine writes otherwise. */
  private warningsOf({ unknown, unbound, doubts }: Answer): string[] {
    const { classes, values } = this.model;
    const known = [...classes.keys(), ...values.properties.map((property) => property.iri)].map(shortened);
    const valueless = unbound.map((name) => `?${name} has no value: no pattern binds it.`);
    return unknown.map(({ what, iri }) => {
      if (iri === HISTORY) return 'The graph of the history is not in the page: cluxel query has it.';
      const name = shortened(iri), near = what === 'graph' ? undefined : nearest(name, known);
      return `The page has no ${what === 'name' ? '' : `${what} `}${name}.${near ? ` Did you mean ${near}?` : ''}`;
    }).concat(valueless, doubts.map((what) => DOUBTS[what]));
  }

  private show(answer: Answer, question: Question | undefined, places: Map<string, Place>): void {
    const warnings = this.warningsOf(answer).map((warning) => `\n${warning}`).join('');
    const time = `${Math.max(1, Math.round(answer.milliseconds))} ms`;
    if (answer.form === 'truth') {
      this.showFault(`${answer.value ? 'Yes' : 'No'} · ${time}${warnings}`);
      queueMicrotask(() => this.status.classList.remove('fault'));
      return;
    }
    const rows: Rows = answer.form === 'rows'
      ? answer
      : { form: 'rows', variables: ['subject', 'predicate', 'object'], rows: answer.triples };
    const finder = new RowObjects(this.model, this.owners ?? new Map());
    const objectsOfRow = rows.rows.map((row) => finder.ofRow(row));
    const objects = [...new Set(objectsOfRow.flat())];
    this.placesOfRow = rows.rows.map((row, i) => (objectsOfRow[i].length > 0 ? undefined : placeIn(row, places)));
    const placeless = objectsOfRow.filter((found, i) => found.length === 0 && !this.placesOfRow[i]).length;
    this.status.textContent = [`${counted(rows.rows.length)} ${rows.rows.length === 1 ? 'row' : 'rows'}`, time,
                               placeless > 0 && `${counted(placeless)} without a place in the map`].filter(Boolean).join(' · ') + warnings;
    this.table.show(rows, question, objectsOfRow, this.placesOfRow.map(Boolean));
    if (this.placesOfRow.some(Boolean)) this.store.set('places', true);
    this.store.set('marks', []);
    this.store.set('tints', null);
    this.showActions(rows, objectsOfRow, question);
    const isRanked = RANKED.test(question?.text ?? this.editor.text) && objectsOfRow.every((found) => found.length <= 1);
    this.store.set('lit', objects.length > 0 ? { objects, ranked: isRanked } : null);
    this.table.mark(this.store.state.selected);
  }

  private showActions(rows: Rows, objectsOfRow: MapObject[][], question: Question | undefined): void {
    const name = (question?.file ?? 'answer').replace(/\.rq$/, '');
    const button = (text: string, act: () => void) => el('button', { type: 'button', class: 'plain', onclick: act }, icon('down'), text);
    this.actions.replaceChildren(
      button('CSV', () => save(`${name}.csv`, 'text/csv', csvOf(rows))),
      button('GeoJSON', () => save(`${name}.geojson`, 'application/geo+json',
                                   geoJsonOf(rows, (row) => objectsOfRow[row][0], this.model))),
      el('button', { type: 'button', class: 'plain', onclick: () => this.clear() }, 'Clear'));
    this.actions.hidden = false;
  }

  private clear(): void {
    this.store.set('lit', null);
    this.table.clear();
    this.actions.hidden = true;
    this.status.textContent = '';
    this.ideas.hidden = false;
    this.address.setQuestion({});
  }

  private chooseRow(objects: MapObject[], place: Place | undefined): void {
    if (place) {
      this.store.set('place', place);
      return this.stage.goToPlace(middleOfPlace(place));
    }
    if (objects.length === 1) {
      this.store.set('selected', objects[0]);
      this.stage.goTo(objects[0].box);
    } else {
      this.store.set('lit', { objects, ranked: false });
    }
  }
}

/** The first place that a row names. */
function placeIn(row: (RdfTerm | null)[], places: Map<string, Place>): Place | undefined {
  return row.map((term) => (term?.kind === 'iri' ? places.get(term.value) : undefined)).find(Boolean);
}
