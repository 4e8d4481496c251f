// SPDX-License-Identifier: Apache-2.0
// The parameters of a task as fields, and their values as a request or a command.
import { capitalised, classWord, type MapModel, type Task, type TaskParameter } from '../data/model';
import { el, iconButton } from '../dom';
import type { Store } from '../state';

export class TaskForm {
  readonly element = el('div', { class: 'task-fields' });
  private task: Task | undefined;

  constructor(private readonly model: MapModel, private readonly store: Store, private readonly run: () => void) {}

  show(task: Task): void {
    this.task = task;
    const classes = [...this.model.classes.values()].sort((a, b) => (a.label < b.label ? -1 : 1));
    this.element.replaceChildren(
      el('datalist', { id: 'task-classes' }, ...classes.map((info) => el('option', { value: classWord(info.iri), label: info.label }))),
      ...task.parameters.map((parameter) => this.field(parameter)));
  }

  /** Names and values of the fields that are filled in and differ from the defaults. */
  values(): [string, string][] {
    return (this.task?.parameters ?? []).flatMap((parameter): [string, string][] => {
      const input = this.element.querySelector<HTMLInputElement>(`[name="${parameter.name}"]`)!;
      const text = parameter.kind === 'flag' ? String(input.checked) : input.value.trim();
      if (text === '' || text === (parameter.default ?? (parameter.kind === 'flag' ? 'false' : ''))) return [];
      if (!parameter.repeated) return [[parameter.name, text]];
      // Names of classes hold spaces. They go as they are typed: the service knows what they mean, or refuses them.
      const between = parameter.kind === 'class' ? /\s*,\s*/ : /[,\s]+/;
      return text.split(between).filter(Boolean).map((one) => [parameter.name, one]);
    });
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
      placeholder: parameter.kind === 'place' ? 'X,Y or an object' : parameter.kind === 'class' ? (parameter.repeated ? 'a class, another class' : 'a class') : undefined,
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
