// SPDX-License-Identifier: Apache-2.0
// The card of the selected place: measures, what it meets and what it is made of, and the rules that made it one.
import { capitalised, nameOf, type MapModel } from '../data/model';
import type { Place, Places } from '../data/places';
import { counted, el, iconButton, rounded, swatch } from '../dom';
import type { Stage } from '../scene/stage';
import type { Store } from '../state';
import { middleOfPlace } from './places';

export class PlaceCard {
  readonly element = el('aside', { class: 'card', hidden: true, 'aria-label': 'Selected place', tabindex: -1 });

  constructor(private readonly model: MapModel, private readonly places: Places, private readonly store: Store,
              private readonly stage: Stage) {
    store.on(['place'], (state) => void this.show(state.place));
  }

  private async show(place: Place | null): Promise<void> {
    this.element.hidden = place === null;
    if (!place) return;
    const all = await this.places.all();
    if (this.store.state.place !== place) return;
    this.element.replaceChildren(this.head(place), this.measures(place), ...this.related(place, all), this.members(place), this.reasons(place));
    this.element.scrollTop = 0;
  }

  private head(place: Place): HTMLElement {
    return el('header', {}, swatch(place.info.color || '#808080', 'large'),
              el('div', { class: 'titles' }, el('h2', {}, capitalised(place.info.label)), el('code', { title: place.iri }, place.id.slice(0, 12))),
              iconButton('aim', 'Go to this place (F)', () => this.stage.goToPlace(middleOfPlace(place))),
              iconButton('close', 'Close the card (Escape)', () => this.store.set('place', null)));
  }

  private measures(place: Place): HTMLElement {
    const item = (name: string, value: string) => el('div', {}, el('dt', {}, name), el('dd', {}, value)), [x, y] = middleOfPlace(place);
    return el('dl', { class: 'measures' },
              ...place.measures.map(({ label, value, unit }) => item(capitalised(label), `${rounded(value, unit === '%' ? 1 : 2)} ${unit}`.trim())),
              item('Position', `${rounded(x, 2)}, ${rounded(y, 2)} m`));
  }

  private related(place: Place, all: Map<string, Place>): HTMLElement[] {
    const meeting = [...all.values()].filter((other) => other.related.some(({ iri }) => iri === place.iri));
    const own = place.related.flatMap(({ label, iri }) => (all.has(iri) ? [{ label, other: all.get(iri)! }] : []));
    const list = (title: string, items: HTMLElement[]) =>
      (items.length === 0 ? [] : [el('section', {}, el('h3', {}, title), el('ul', { class: 'parts' }, ...items))]);
    return [...list('Leads to', own.map(({ label, other }) => el('li', {}, this.button(other), el('small', {}, label)))),
            ...list(place.kind === 'mark' ? 'Ways that meet here' : 'Ways in it', meeting.map((other) => el('li', {}, this.button(other), el('small', {}, sizeOf(other)))))];
  }

  private button(place: Place): HTMLElement {
    const go = () => {
      this.store.set('place', place);
      this.stage.goToPlace(middleOfPlace(place));
    };
    return el('button', { type: 'button', class: 'plain', onclick: go }, swatch(place.info.color || '#808080'), `${capitalised(place.info.label)} ${place.id.slice(0, 8)}`);
  }

  private members(place: Place): HTMLElement | string {
    if (place.members.length === 0) return '';
    return el('section', {}, el('h3', {}, `Made of ${counted(place.members.length)}`), el('ul', { class: 'parts' }, ...place.members.map((object) =>
      el('li', {}, el('button', { type: 'button', class: 'plain', onclick: () => { this.store.set('selected', object); this.stage.goTo(object.box); } },
                      swatch(object.class.color || '#808080'), nameOf(object))))));
  }

  private reasons(place: Place): HTMLElement {
    const rules = place.rules.map(({ info, file }) => {
      const text = this.model.values.sparqlRules.find((rule) => rule.name === file)?.text ?? '';
      return el('details', { class: 'why', open: true }, el('summary', {}, `Why ${capitalised(info.label)}?`),
                el('p', { class: 'rule-comment' }, commentOf(text)), el('small', { class: 'place' }, file),
                text && el('details', {}, el('summary', {}, 'The rule'), el('pre', { class: 'statement', tabindex: 0 }, text)));
    });
    if (rules.length > 0) return el('div', { class: 'reasons' }, ...rules);
    return el('div', { class: 'reasons' }, el('p', { class: 'note' }, 'It was measured in the ground when the map was made; no rule took part.'));
  }
}

function sizeOf(place: Place): string {
  return place.measures.filter(({ label }) => label === 'length' || label === 'width').map(({ label, value, unit }) => `${label} ${rounded(value, 1)} ${unit}`).join(', ');
}

/** The lines at the head of a SPARQL rule say what it does. */
function commentOf(text: string): string {
  const lines = text.split('\n'), end = lines.findIndex((line) => !line.startsWith('#'));
  return lines.slice(0, end < 0 ? lines.length : end).map((line) => line.replace(/^#\s*/, '')).join(' ');
}
