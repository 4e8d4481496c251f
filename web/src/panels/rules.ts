// SPDX-License-Identifier: Apache-2.0
// The rule file beside the map. A changed text is tried by the service; what it would change is coloured.
import { capitalised, CLX, type MapModel, type RuleFile } from '../data/model';
import type { Service } from '../data/service';
import type { Trial, TrialChange } from '../data/trial';
import { counted, el, icon, messageOf, rounded, swatch } from '../dom';
import { save } from '../downloads';
import { cssOf, rgbOf, type Rgb } from '../scene/palette';
import type { Stage } from '../scene/stage';
import type { Mark, Store } from '../state';

const PAUSE_MS = 700;
const MOST_LINES = 200;
const KINDS: Record<TrialChange['kind'], { colour: Rgb; label: string }> = {
  class: { colour: [213, 94, 0], label: 'other class' }, parts: { colour: [230, 159, 0], label: 'other parts' },
  confidence: { colour: [240, 228, 66], label: 'other confidence' }, rule: { colour: [86, 180, 233], label: 'other rule' },
  added: { colour: [0, 158, 115], label: 'added' }, removed: { colour: [204, 121, 167], label: 'removed' },
};
type Look = 'kind' | 'before' | 'after';

export class RulePanel {
  readonly element: HTMLElement;
  private readonly text: HTMLTextAreaElement;
  private readonly status = el('p', { class: 'status', role: 'status' });
  private readonly list = el('div', { class: 'trial' });
  private readonly looks: HTMLElement;
  private readonly reset: HTMLButtonElement;
  private file: RuleFile;
  private trial: Trial | null = null;
  private look: Look = 'kind';
  private timer = 0;
  private asked = 0;

  constructor(private readonly model: MapModel, private readonly service: Service | undefined, private readonly store: Store,
              private readonly stage: Stage) {
    const files = model.values.rules.filter((file) => file.root);
    this.file = files[0] ?? { name: '', text: '', root: true };
    const choose = el('select', { id: 'rule-file', onchange: () => this.open(files[Number(choose.value)]) },
                      ...files.map((file, i) => el('option', { value: i }, file.name)));
    this.text = el('textarea', { id: 'rule-text', spellcheck: 'false', wrap: 'off', autocomplete: 'off',
                                 'aria-label': 'Rules', oninput: () => this.schedule() });
    this.reset = el('button', { type: 'button', onclick: () => this.open(this.file), disabled: true }, 'Undo all');
    const keep = el('button', { type: 'button', class: 'plain', onclick: () => save(this.file.name, 'application/yaml', this.text.value) },
                    icon('down'), 'Save as a file');
    this.looks = el('fieldset', { class: 'looks', hidden: true }, el('legend', {}, 'Coloured by'),
                    this.lookButton('kind', 'what changes'), this.lookButton('before', 'class before'), this.lookButton('after', 'class after'));
    this.element = el('section', { class: 'panel rules' },
                      files.length > 1 && el('div', { class: 'field' }, el('label', { for: 'rule-file' }, 'File'), choose),
                      this.text, this.tokenField(), el('div', { class: 'row' }, this.reset, keep), this.status, this.looks, this.list);
    store.on(['ruleLine'], (state) => { if (state.ruleLine) this.showLine(state.ruleLine); });
    store.on(['tints'], (state) => { if (!state.tints && this.trial && this.trial.changes.length > 0) this.forget(); });
    this.open(this.file);
  }

  private tokenField(): HTMLElement | null {
    const { service } = this;
    if (!service) return null;
    return el('div', { class: 'field' }, el('label', { for: 'token' }, 'Token of the service'),
              el('input', { type: 'text', id: 'token', class: 'secret', autocomplete: 'off', spellcheck: 'false', oninput: (event: Event) => {
                service.token = (event.target as HTMLInputElement).value;
                if (this.isChanged) this.schedule();
              } }));
  }

  private lookButton(look: Look, label: string): HTMLElement {
    const id = `look-${look}`;
    return el('label', { for: id }, el('input', { type: 'radio', name: 'look', id, value: look, checked: look === 'kind',
                                                  onchange: () => { this.look = look; this.colour(); } }), label);
  }

  private get isChanged(): boolean {
    return this.text.value !== this.file.text;
  }

  private open(file: RuleFile): void {
    this.file = file;
    this.text.value = file.text;
    this.forget();
    this.store.set('tints', null);
    this.status.textContent = this.service
      ? 'Change a threshold: the service tells what it would change. The map stays as it is.'
      : 'This file has no service that tries rules. Save a changed text as FILE, and run: cluxel rules try MAP FILE';
  }

  /** An answer that is still under way is for an earlier text. */
  private dropAnswers(): void {
    window.clearTimeout(this.timer);
    ++this.asked;
    this.element.setAttribute('aria-busy', 'false');
  }

  private forget(): void {
    this.dropAnswers();
    this.trial = null;
    this.looks.hidden = true;
    this.list.replaceChildren();
    this.reset.disabled = !this.isChanged;
    this.status.classList.remove('fault');
    this.store.set('marks', []);
  }

  private showLine({ file, line }: { file: string; line: number }): void {
    if (file.slice(file.lastIndexOf('/') + 1) !== this.file.name) return;
    const lines = this.text.value.split('\n'), start = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    this.text.focus();
    this.text.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
    this.text.scrollTop = Math.max(0, (this.text.scrollHeight * (line - 4)) / lines.length);
  }

  private schedule(): void {
    this.reset.disabled = !this.isChanged;
    this.dropAnswers();
    if (!this.service) return;
    if (!this.isChanged) return this.open(this.file);
    this.timer = window.setTimeout(() => void this.ask(), PAUSE_MS);
  }

  private async ask(): Promise<void> {
    const asked = ++this.asked;
    this.element.setAttribute('aria-busy', 'true');
    this.status.classList.remove('fault');
    this.status.textContent = 'Trying…';
    try {
      const trial = JSON.parse(await this.service!.post('rules/trial', 'application/yaml', this.text.value)) as Trial;
      if (asked !== this.asked) return;
      this.show(trial);
    } catch (fault) {
      if (asked !== this.asked) return;
      this.status.textContent = messageOf(fault);
      this.status.classList.add('fault');
    }
    this.element.setAttribute('aria-busy', 'false');
  }

  private show(trial: Trial): void {
    this.trial = trial;
    this.looks.hidden = trial.changes.length === 0;
    this.status.textContent = trial.changes.length === 0 ? 'Nothing changes.'
      : `${counted(trial.changes.length)} objects change; ${counted(trial.before)} objects before, ${counted(trial.after)} after`;
    if (this.service?.note) this.status.textContent += `\n${this.service.note}`;
    this.colour();
    const kinds = (Object.keys(KINDS) as TrialChange['kind'][]).filter((kind) => trial.counts[kind] > 0);
    this.list.replaceChildren(
      el('ul', { class: 'labels' }, ...kinds.map((kind) => el('li', { 'data-kind': kind }, swatch(cssOf(KINDS[kind].colour)), `${KINDS[kind].label}: `,
                                                              el('b', {}, counted(trial.counts[kind]))))),
      el('ol', { class: 'change-list' }, ...trial.changes.slice(0, MOST_LINES).map((change) => el('li', {}, this.button(change)))),
      trial.changes.length > MOST_LINES ? el('p', { class: 'note' }, `${counted(trial.changes.length - MOST_LINES)} more`) : '');
  }

  private button(change: TrialChange): HTMLElement {
    const { before, after, place } = change, [from, to] = [before, after].map((one) => (one ? this.classNamed(one.class).label : 'nothing'));
    const confidence = before && after ? `, confidence ${rounded(before.confidence)} → ${rounded(after.confidence)}` : '';
    return el('button', { type: 'button', class: 'plain', onclick: () => {
      const object = this.model.objectStartingWith(before?.id ?? '');
      if (object) this.store.set('selected', object);
      this.stage.goToPlace(place);
    } }, swatch(cssOf(KINDS[change.kind].colour)), `${capitalised(from === to ? from : `${from} → ${to}`)}${confidence}`);
  }

  private classNamed(name: string) {
    return this.model.classOf(CLX + name);
  }

  /** Objects of the map in the colours of the trial; what would be new has a mark at its place. */
  private colour(): void {
    const { trial, look } = this;
    if (!trial) return;
    const tints = new Map<number, Rgb>(), marks: Mark[] = [];
    trial.changes.forEach((change, i) => {
      const object = this.model.objectStartingWith(change.before?.id ?? '');
      if (!object) marks.push({ text: '+', title: `Change ${i + 1}: ${change.after?.class ?? ''}`, place: change.place });
      const judged = look === 'after' ? change.after : change.before;
      const colour = look === 'kind' ? KINDS[change.kind].colour : judged && rgbOf(this.classNamed(judged.class).color);
      if (object && colour) tints.set(object.number, colour);
    });
    this.store.set('lit', null);
    this.store.set('tints', trial.changes.length > 0 ? tints : null);
    this.store.set('marks', look === 'before' ? [] : marks);
  }
}
