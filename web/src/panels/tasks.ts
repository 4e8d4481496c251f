// SPDX-License-Identifier: Apache-2.0
// Tasks by name, with their parameters. The service answers them; a file shows the command that does.
import { type MapModel, type MapObject, type Question, type Task } from '../data/model';
import type { Service, TaskAnswer, TaskRow } from '../data/service';
import { counted, el, icon, messageOf } from '../dom';
import { save } from '../downloads';
import type { GroundHeights } from '../scene/ground';
import type { Stage } from '../scene/stage';
import type { RdfTerm, Rows } from '../sparql/answers';
import type { Mark, Store } from '../state';
import { AnswerTable, RowObjects } from './table';
import { TaskForm } from './task_form';

const DECIMAL = 'http://www.w3.org/2001/XMLSchema#decimal';
type Values = [string, string][];
const LOCAL: Values = [['frame', 'local']];
const IRI = /^https?:\/\/\S+$/;

export class TaskPanel {
  readonly element: HTMLElement;
  private readonly tasks: Task[];
  private readonly form: TaskForm;
  private readonly status = el('p', { class: 'status', role: 'status' });
  private readonly actions = el('div', { class: 'actions', hidden: true });
  private readonly reasons = el('div', { class: 'task-reasons' });
  private readonly run = el('button', { type: 'button', class: 'primary', onclick: () => void this.ask() }, icon('run'), 'Ask');
  private readonly buttons: HTMLButtonElement[];
  private readonly table: AnswerTable;
  private task: Task | undefined;
  private asked = 0;

  constructor(private readonly model: MapModel, private readonly service: Service | undefined,
              private readonly store: Store, private readonly stage: Stage, private readonly ground: GroundHeights) {
    // Shipped questions have a panel of their own, which answers without a service.
    this.tasks = model.values.tasks.filter((task) => !task.file);
    this.form = new TaskForm(model, store, () => void this.ask());
    this.table = new AnswerTable(model, { choose: (objects, row) => this.chooseRow(objects, row) });
    this.buttons = this.tasks.map((task) => el('button', { type: 'button', 'aria-pressed': 'false', title: task.title,
                                                           'data-task': task.name, onclick: () => this.choose(task) }, task.name));
    this.element = el('section', { class: 'panel tasks' }, el('div', { class: 'task-buttons' }, ...this.buttons),
                      el('p', { class: 'task-title' }), this.form.element, el('div', { class: 'row' }, this.run), this.status,
                      this.actions, this.reasons, this.table.element);
    store.on(['selected'], (state) => this.table.mark(state.selected));
    if (this.tasks.length > 0) this.choose(this.tasks[0]);
  }

  private choose(task: Task): void {
    this.task = task;
    this.buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(this.tasks[i] === task)));
    this.element.querySelector('.task-title')!.textContent = task.title;
    this.form.show(task);
    this.clear();
    if (!this.service) this.status.textContent = 'This file answers the shipped questions by itself. Tasks need the service: cluxel serve MAP.';
  }

  /** Also drops an answer that is still under way. */
  private clear(): void {
    ++this.asked;
    this.busy(false);
    this.table.clear();
    this.reasons.replaceChildren();
    this.actions.hidden = true;
    this.status.textContent = '';
    this.status.classList.remove('fault');
    this.store.set('marks', []);
    this.store.set('lit', null);
  }

  private async ask(): Promise<void> {
    const task = this.task;
    if (!task || this.run.disabled) return;
    const missing = this.form.missing();
    this.clear();
    if (missing.length > 0) return this.fault(`${missing.map((one) => `${one.name}: ${one.help}`).join('\n')}`);
    if (!this.service) return this.showCommand(task);
    const values = this.form.values(), asked = this.asked;
    this.busy(true);
    this.status.textContent = 'Asking…';
    try {
      const answer = await this.service.json<TaskAnswer>(requestOf(task, values, task.reasons ? [['why', 'true']] : []));
      if (asked !== this.asked) return;
      this.show(task, answer, values);
    } catch (fault) {
      if (asked !== this.asked) return;
      this.fault(messageOf(fault));
    }
    this.busy(false);
  }

  private busy(on: boolean): void {
    this.run.disabled = on;
    this.element.setAttribute('aria-busy', String(on));
  }

  private fault(message: string): void {
    this.status.textContent = message;
    this.status.classList.add('fault');
  }

  /** What to run where there is no service. */
  private showCommand(task: Task): void {
    const quoted = (text: string) => (/^[\w.,=:+-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`);
    const values = this.form.values().map(([name, value]) => quoted(`${name}=${value}`));
    this.status.textContent = 'This file has no service to ask. This command gives the answer:';
    this.reasons.replaceChildren(el('code', { class: 'statement' }, ['cluxel ask MAP', task.name, ...values].join(' ')));
  }

  private show(task: Task, answer: TaskAnswer, values: Values): void {
    const rows = rowsOf(answer), finder = new RowObjects(this.model, new Map());
    const objectsOfRow = rows.rows.map((row) => finder.ofRow(row).slice(0, 1));
    const marks = answer.rows.map((row, i) => this.markOf(row, objectsOfRow[i], i));
    const placeless = marks.filter((mark, i) => !mark && !answer.rows[i].geometry && objectsOfRow[i].length === 0).length;
    this.status.textContent = [`${counted(answer.rows.length)} ${answer.rows.length === 1 ? 'row' : 'rows'}`,
                               placeless > 0 && `${counted(placeless)} without a place in the map`, ...answer.notes, this.service?.note].filter(Boolean).join(' · ');
    const question: Question = { file: task.name, title: task.title, text: '', parameters: [], columns: answer.columns };
    this.marksOfRow = marks;
    this.table.show(rows, question, objectsOfRow, marks.map(Boolean));
    this.showActions(task, values);
    this.showReasons(answer);
    const objects = [...new Set(objectsOfRow.flat())];
    this.store.set('marks', marks.filter((mark): mark is Mark => mark !== null && mark.text !== ''));
    this.store.set('lit', objects.length > 0 ? { objects, ranked: false } : null);
  }

  private marksOfRow: (Mark | null)[] = [];

  /** A number at the place of the row; rows of objects are lit instead, and have a mark only where they have a way. */
  private markOf({ geometry: shape, way }: TaskRow, objects: MapObject[], row: number): Mark | null {
    const onGround = ([x, y]: number[]) => [x, y, this.ground.at(x, y)];
    if (shape?.type === 'Point') {
      const place = onGround(shape.coordinates as number[]);
      return { text: objects.length > 0 ? '' : String(row + 1), title: `Row ${row + 1}`, place, path: way };
    }
    if (shape?.type !== 'LineString') return null;
    const path = shape.coordinates as number[][];
    return { text: String(row + 1), title: `Row ${row + 1}`, place: onGround(path[path.length - 1]), path };
  }

  private chooseRow(objects: MapObject[], row: number): void {
    const mark = this.marksOfRow[row];
    if (objects.length > 0) {
      this.store.set('selected', objects[0]);
      this.stage.goTo(objects[0].box);
    } else if (mark) {
      this.stage.goToPlace(mark.place);
    }
  }

  private showActions(task: Task, values: Values): void {
    const get = (format: string, ending: string, type: string) => async () => {
      const asked = this.asked;
      try {
        save(`${task.name}.${ending}`, type, await this.service!.text(
          requestOf(task, values, [['format', format], ...(format === 'geojson' ? LOCAL : [])])));
      } catch (fault) {
        if (asked === this.asked) this.fault(messageOf(fault));
      }
    };
    const button = (text: string, act: () => void) => el('button', { type: 'button', class: 'plain', onclick: act }, icon('down'), text);
    this.actions.replaceChildren(button('CSV', get('csv', 'csv', 'text/csv')),
                                 button('GeoJSON', get('geojson', 'geojson', 'application/geo+json')),
                                 el('button', { type: 'button', class: 'plain', onclick: () => this.clear() }, 'Clear'));
    this.actions.hidden = false;
  }

  private showReasons(answer: TaskAnswer): void {
    const told = answer.rows.flatMap((row, i) => (row.why?.length ? [{ row: i + 1, why: row.why }] : []));
    if (told.length === 0) return this.reasons.replaceChildren();
    this.reasons.replaceChildren(el('details', {}, el('summary', {}, 'Why?'), ...told.map(({ row, why }) =>
      el('div', {}, el('b', {}, `Row ${row}`), el('ul', {}, ...why.map((line) => el('li', {}, line)))))));
  }
}

function requestOf(task: Task, values: Values, more: Values): string {
  const query = new URLSearchParams([...values, ...more]).toString();
  return `tasks/${encodeURIComponent(task.name)}${query && '?'}${query}`;
}

/** Cells of a task as terms: what the table shows is the same for questions and tasks. */
function rowsOf(answer: TaskAnswer): Rows {
  const termOf = (cell: unknown): RdfTerm | null => {
    if (cell === null || cell === undefined) return null;
    if (typeof cell === 'number') return { kind: 'literal', value: String(cell), datatype: DECIMAL };
    const text = String(cell);
    return IRI.test(text) ? { kind: 'iri', value: text } : { kind: 'literal', value: text };
  };
  const variables = answer.columns.map((column) => column.name);
  return { form: 'rows', variables, rows: answer.rows.map((row) => variables.map((name) => termOf(row[name]))) };
}
