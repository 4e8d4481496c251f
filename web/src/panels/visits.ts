// SPDX-License-Identifier: Apache-2.0
// A slider over visits: what each one found appeared, vanished and moved, and what it did not observe.
import { capitalised, localName, middleOf, nameOf, OBJECT, type MapModel, type MapObject, type SiteChange, type VisitChanges } from '../data/model';
import { counted, el, faultNote, rounded, swatch } from '../dom';
import { cssOf, type Rgb } from '../scene/palette';
import type { Stage } from '../scene/stage';
import type { Mark, Store } from '../state';

type Kind = SiteChange['change'] | 'unobserved';
/** Okabe and Ito's colours: apart for all kinds of colour sight. */
const KINDS: Record<Kind, { colour: Rgb; label: string }> = {
  appeared: { colour: [0, 114, 178], label: 'appeared' },
  vanished: { colour: [213, 94, 0], label: 'vanished' },
  moved: { colour: [230, 159, 0], label: 'moved' },
  unobserved: { colour: [204, 121, 167], label: 'not observed' },
};

/** By the number of visits: none, one, more. */
const HINTS = [
  'No scan of the map has a time and a pose, so nothing tells what came later. Give times with the scans (times.txt, or a manifest), build the map again and write this page anew.',
  'The map has one visit: nothing can be compared.',
  'first visit; move the slider to a later one',
];

export class VisitPanel {
  readonly element: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly shown = el('output', { class: 'count', for: 'visit' });
  private readonly own = el('input', { type: 'checkbox', id: 'visit-points', onchange: () => this.showScans() });
  private readonly list = el('div', { class: 'visit-list' });
  private isShowing = false;

  constructor(private readonly model: MapModel, private readonly store: Store, private readonly stage: Stage) {
    const { visits } = model.values;
    this.slider = el('input', { type: 'range', id: 'visit', min: 0, max: Math.max(0, visits.length - 1), step: 1, value: 0,
                                disabled: visits.length < 2, oninput: () => void this.show() });
    this.element = el('section', { class: 'panel visits' },
                      el('div', { class: 'field' }, el('label', { for: 'visit' }, 'Visit'), this.slider, this.shown),
                      el('div', { class: 'field flag' }, this.own, el('label', { for: 'visit-points' }, 'Only the points of this visit')),
                      this.list);
    store.on(['tints'], (state) => { if (!state.tints && !this.isShowing && this.slider.value !== '0') this.reset(); });
    this.reset();
  }

  /** Shows no visit by itself. */
  private reset(): void {
    const { visits } = this.model.values;
    this.slider.value = '0';
    this.name(HINTS[Math.min(visits.length, 2)]);
    this.list.replaceChildren();
    if (this.own.checked) {
      this.own.checked = false;
      this.showScans();
    }
    this.own.disabled = visits.length < 2;
  }

  private name(text: string): void {
    this.shown.textContent = text;
    this.slider.setAttribute('aria-valuetext', text);
  }

  private async show(): Promise<void> {
    const number = Number(this.slider.value), { visits } = this.model.values;
    if (this.own.checked) this.showScans();
    if (number === 0) {
      this.store.set('marks', []);
      this.store.set('tints', null);
      return this.reset();
    }
    this.name(`${number + 1} of ${visits.length}, ${timeText(visits[number].begin)}, ${counted(visits[number].scans)} scans`);
    const isShown = () => Number(this.slider.value) === number;
    try {
      const found = (await this.model.changes())[number - 1];
      if (isShown()) this.showChanges(found);
    } catch (fault) {
      if (isShown()) this.showFault(fault);
    }
  }

  /** Nothing of another visit stays in the view. */
  private showFault(fault: unknown): void {
    this.isShowing = true;
    this.store.set('marks', []);
    this.store.set('tints', null);
    this.isShowing = false;
    this.list.replaceChildren(faultNote(fault));
  }

  private showChanges(found: VisitChanges): void {
    const tints = new Map<number, Rgb>(), unseen = found.states.filter((states) => states.before === 'present' && states.after === 'not observed');
    for (const states of unseen) tints.set(states.number, KINDS.unobserved.colour);
    for (const change of found.changes)
      for (const thing of [change, change.now])
        if (thing && thing.number !== null && !thing.part) tints.set(thing.number, KINDS[change.change].colour);
    this.isShowing = true;
    this.store.set('lit', null);
    this.store.set('tints', tints);
    this.store.set('marks', found.changes.map((change, i) => markOf(change, i)));
    this.isShowing = false;
    const count = (kind: Kind) => (kind === 'unobserved' ? unseen.length : found.changes.filter((change) => change.change === kind).length);
    this.list.replaceChildren(
      el('ul', { class: 'labels visit-kinds' }, ...(Object.keys(KINDS) as Kind[]).map((kind) =>
        el('li', { 'data-kind': kind }, swatch(cssOf(KINDS[kind].colour)), `${KINDS[kind].label}: `, el('b', {}, counted(count(kind)))))),
      el('ol', { class: 'change-list' }, ...found.changes.map((change) => el('li', {}, this.button(change)))),
      unseen.length === 0 ? '' : el('details', {}, el('summary', {}, 'Not observed on this visit'),
        el('ul', { class: 'change-list' }, ...unseen.map((states) => el('li', {}, this.objectButton(states.number))))));
  }

  private button(change: SiteChange): HTMLElement {
    const object = change.number === null ? undefined : this.model.objects[change.number], at = middleOf(change);
    const name = object ? nameOf(object) : 'something without a name';
    const moved = change.distance === undefined ? '' : ` by ${rounded(change.distance, 1)} m`;
    return el('button', { type: 'button', class: 'plain', onclick: () => this.goTo(object, at) },
              swatch(cssOf(KINDS[change.change].colour)),
              `${capitalised(change.change)}${moved}: ${change.part ? 'part of ' : ''}${name} at ${rounded(at[0], 1)}, ${rounded(at[1], 1)}`);
  }

  private objectButton(number: number): HTMLElement {
    const object = this.model.objects[number];
    return el('button', { type: 'button', class: 'plain', onclick: () => this.goTo(object, [object.box.x, object.box.y, object.box.z]) },
              nameOf(object));
  }

  private goTo(object: MapObject | undefined, place: number[]): void {
    if (object) this.store.set('selected', object);
    this.stage.goToPlace(place);
  }

  /** The points of the chosen visit alone, or all. */
  private showScans(): void {
    const visit = this.model.values.visits[Number(this.slider.value)], { clouds } = this.model.values;
    if (!this.own.checked || !visit) return this.store.set('scans', null);
    const isIn = clouds.map((cloud) => cloud.time !== undefined && cloud.time >= visit.begin && cloud.time <= visit.end);
    this.store.set('scans', [isIn.indexOf(true), isIn.lastIndexOf(true)]);
  }
}

function markOf(change: SiteChange, number: number): Mark {
  const place = middleOf(change), path = change.now ? [place, middleOf(change.now)] : undefined;
  return { text: String(number + 1), title: `${change.change} ${localName(change.object ?? OBJECT).slice(0, 8)}`, place, path,
           boxes: [change.box_m, ...(change.now ? [change.now.box_m] : [])] };
}

function timeText(seconds: number): string {
  return new Date(1000 * seconds).toISOString().slice(0, 16).replace('T', ' ');
}
