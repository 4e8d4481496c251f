// SPDX-License-Identifier: Apache-2.0
// Why an object has not a class that a person expects: the reasons in the page where a rule decided, else the service's.
import { classWord, CLX, type MapModel, type MapObject, type Verdict } from '../data/model';
import type { Service } from '../data/service';
import { el, faultNote } from '../dom';
import { verdictBody } from './reasons';

interface WhyNot { class: string; rules: (Verdict & { outcome: string })[] }

export class WhyNotQuestion {
  readonly element: HTMLElement;
  private readonly answer = el('div', { class: 'why-not-answer', role: 'status' });

  constructor(private readonly model: MapModel, private readonly service: Service | undefined, private readonly object: MapObject) {
    const classes = model.shownClasses.map(({ info }) => info).filter((info) => info !== object.class);
    const select = el('select', { id: 'why-not', onchange: () => void this.ask(select.value) }, el('option', { value: '' }, 'choose a class'),
                      ...classes.map((info) => el('option', { value: classWord(info.iri) }, model.titleOf(info))));
    this.element = el('div', { class: 'why-not-question' }, el('label', { for: 'why-not', class: 'label' }, 'Why is it not a …?'), select, this.answer);
  }

  private asked = 0;

  private async ask(name: string): Promise<void> {
    this.answer.replaceChildren();
    ++this.asked;
    if (!name) return;
    if (this.service) return this.askService(name);
    const verdicts = ((await this.model.reasonsOf(this.object))?.decisions ?? []).filter((verdict) =>
      !verdict.accepted && classWord(verdict.class.replace(/^clx:/, CLX)) === name);
    if (verdicts.length > 0) return this.show(verdicts);
    this.answer.replaceChildren(el('p', { class: 'note' }, 'No rule of this class looked at it before another had it. This command tells more:'),
                                el('code', { class: 'statement' }, `cluxel explain MAP ${this.object.id.slice(0, 12)} --why-not ${/^\w+$/.test(name) ? name : `'${name}'`}`));
  }

  private async askService(name: string): Promise<void> {
    const asked = ++this.asked;  // a late answer to an earlier question is dropped
    this.answer.replaceChildren(el('p', { class: 'note' }, 'Asking…'));
    try {
      const told = await this.service!.json<WhyNot>(`objects/${this.object.id}/explanation?whyNot=${encodeURIComponent(name)}`);
      if (asked !== this.asked) return;
      if (told.rules.length > 0) this.show(told.rules);
      else this.answer.replaceChildren(el('p', { class: 'note' }, 'No rule makes this class.'));
      if (this.service!.note) this.answer.append(el('p', { class: 'note' }, this.service!.note));
    } catch (fault) {
      if (asked !== this.asked) return;
      this.answer.replaceChildren(faultNote(fault));
    }
  }

  private show(verdicts: Verdict[]): void {
    this.answer.replaceChildren(...verdicts.map((verdict) => el('div', { class: 'why-not' }, ...verdictBody(verdict, this.model))));
  }
}
