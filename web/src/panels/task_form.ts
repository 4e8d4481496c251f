// SPDX-License-Identifier: Apache-2.0
// The parameters of a task as fields, and their values as a request or a command.
import { capitalised, localName, type MapModel, type Task, type TaskParameter } from '../data/model';
import { el, iconButton } from '../dom';
import type { Store } from '../state';

export class TaskForm {
  readonly element = el('div', { class: 'task-fields' });
  private task: Task | undefined;

  constructor(private readonly model: MapModel, private readonly store: Store, private readonly run: () => void) {}

  show(task: Task): void {
    this.task = task;
    const classes = [...new Set([...this.model.classes.keys()].map(localName))].sort();
    this.element.replaceChildren(
      el('datalist', { id: 'task-classes' }, ...classes.map((name) => el('option', { value: name }))),
      ...task.parameters.map((parameter) => this.field(parameter)));
  }

  /** Names and values of the fields that are filled in and differ from the defaults. */
  values(): [string, string][] {
    return (this.task?.parameters ?? []).flatMap((parameter): [string, string][] => {
      const input = this.element.querySelector<HTMLInputElement>(`[name="${parameter.name}"]`)!;
      const text = parameter.kind === 'flag' ? String(input.checked) : input.value.trim();
      if (text === '' || text === (parameter.default ?? (parameter.kind === 'flag' ? 'false' : ''))) return [];
      const texts = parameter.kind === 'class' ? this.classNames(text, parameter.repeated ?? false)
        : parameter.repeated ? text.split(/[,\s]+/).filter(Boolean) : [text];
      return texts.map((one) => [parameter.name, one]);
    });
  }

  /** Several stand between commas or, without spaces in them, between spaces. */
  private classNames(text: string, isRepeated: boolean): string[] {
    if (!isRepeated) return [this.classNamed(text) ?? text];
    return text.split(',').map((one) => one.trim()).filter(Boolean).flatMap((one) =>
      this.classNamed(one) ?? one.split(/\s+/).map((word) => this.classNamed(word) ?? word));
  }

  /** "street sign" and "streetsign" as "StreetSign"; names that no class has are for the service to judge. */
  private classNamed(text: string): string | undefined {
    const plain = (name: string) => name.toLowerCase().replace(/\s+/g, '');
    const named = [...this.model.classes.values()].find((info) => plain(localName(info.iri)) === plain(text) || plain(info.label) === plain(text));
    return named && localName(named.iri);
  }

  /** What is required and empty. */
  missing(): TaskParameter[] {
    const given = new Set(this.values().map(([name]) => name));
    return (this.task?.parameters ?? []).filter((parameter) => parameter.required && !given.has(parameter.name));
  }

  private field(parameter: TaskParameter): HTMLElement {
    const id = `task-${parameter.name}`, unit = parameter.unit && parameter.unit !== '1' ? ` [${parameter.unit}]` : '';
    const label = el('label', { for: id, title: parameter.help },
                     `${capitalised(spaced(parameter.name))}${unit}${parameter.required ? ' *' : ''}`);
    if (parameter.kind === 'flag')
      return el('div', { class: 'field flag' }, el('input', { type: 'checkbox', id, name: parameter.name,
                                                               checked: parameter.default === 'true' }), label);
    const isNumber = parameter.kind === 'number' || parameter.kind === 'whole number';
    const input = el('input', {
      type: 'text', id, name: parameter.name, value: parameter.default ?? '', autocomplete: 'off', title: parameter.help,
      list: parameter.kind === 'class' ? 'task-classes' : undefined, inputmode: isNumber ? 'decimal' : undefined,
      placeholder: parameter.kind === 'place' ? 'X,Y or an object' : parameter.kind === 'class' ? 'a class' : undefined,
      required: parameter.required ?? false,
      onkeydown: (event: KeyboardEvent) => { if (event.key === 'Enter') this.run(); },
    });
    if (parameter.kind !== 'place') return el('div', { class: 'field' }, label, input);
    const take = iconButton('aim', `Take the selected object for ${spaced(parameter.name)}`, () => {
      const object = this.store.state.selected;
      if (object) input.value = object.id.slice(0, 12);
    });
    return el('div', { class: 'field' }, label, el('div', { class: 'with-button' }, input, take));
  }
}

/** "maxStep" as "max step". */
function spaced(name: string): string {
  return name.replace(/([a-z])([A-Z])/g, (_, a: string, b: string) => `${a} ${b.toLowerCase()}`);
}
