// SPDX-License-Identifier: Apache-2.0
// The layer of places: what is drawn of them, what the legend says of it, and going from one to the next.
import { capitalised, type ClassInfo } from '../data/model';
import type { Place, Places } from '../data/places';
import { counted, el, faultNote, swatch } from '../dom';
import { cssOf, distinctColour } from '../scene/palette';
import type { PlaceLines } from '../scene/place_lines';
import type { Stage } from '../scene/stage';
import type { Store } from '../state';

const ACCENT = { light: '#0b5fd0', dark: '#7ab4ff' };

export class PlacePanel {
  /** Stands in the legend while places are shown. */
  readonly element = el('fieldset', { class: 'heights places', hidden: true });
  private found: Place[] = [];
  private readonly hidden = new Set<ClassInfo>();
  /** With their places, most frequent first. */
  private groups: [ClassInfo, Place[]][] = [];

  /** `ready`: when the ground is known. */
  constructor(private readonly places: Places, private readonly lines: PlaceLines,
              private readonly store: Store, private readonly stage: Stage, private readonly ready: Promise<void>) {
    store.on(['places'], () => void this.toggle());
    store.on(['place', 'theme'], () => this.draw());
    store.on(['colourMode'], () => {
      if (this.groups.length > 0) this.list();
      this.draw();
    });
    store.on(['place'], (state) => { if (state.place) store.set('places', true); });
  }

  private async toggle(): Promise<void> {
    const isShown = this.store.state.places;
    this.element.hidden = !isShown;
    if (!isShown) {
      this.store.set('place', null);
      return this.draw();
    }
    if (this.found.length > 0) return this.draw();
    this.tell(el('p', { class: 'note', role: 'status' }, 'Reading…'));
    try {
      await this.ready;
      this.found = [...(await this.places.all()).values()];
      this.groups = groupsOf(this.found);
      if (this.found.length > 0) this.list();
      else this.tell(el('p', { class: 'note', role: 'status' }, 'The map holds none.'));
    } catch (fault) {
      this.tell(faultNote(fault));
    }
    this.draw();
  }

  private tell(content: HTMLElement): void {
    this.element.replaceChildren(el('legend', {}, 'Ways and places'), content);
  }

  private list(): void {
    this.tell(el('ul', { class: 'classes' }, ...this.groups.map(([info, group]) => {
      const next = el('button', { type: 'button', class: 'only', onclick: () => this.step(group), 'aria-label': `Go to the next ${info.label}` }, 'next');
      const box = el('input', { type: 'checkbox', checked: !this.hidden.has(info), onchange: () => this.hide(info, !box.checked) });
      return el('li', { 'data-class': info.iri },
                el('label', { title: info.comment || undefined }, box, swatch(this.colourOf(info), `shape-${group[0].kind}`),
                   el('span', { class: 'class-name' }, capitalised(info.label))),
                el('span', { class: 'count' }, counted(group.length)), next);
    })));
  }

  /** In the colours that all kinds of sight tell apart where those of the classes are in these. */
  private colourOf(info: ClassInfo): string {
    if (this.store.state.colourMode !== 'distinct') return info.color || '#808080';
    return cssOf(distinctColour(this.groups.findIndex(([other]) => other === info)));
  }

  private hide(info: ClassInfo, isHidden: boolean): void {
    if (isHidden) this.hidden.add(info);
    else this.hidden.delete(info);
    this.draw();
  }

  private step(group: Place[]): void {
    const { place } = this.store.state, next = group[((place ? group.indexOf(place) : -1) + 1) % group.length];
    this.store.set('place', next);
    this.stage.goToPlace(middleOfPlace(next));
  }

  private draw(): void {
    const { places, place, theme } = this.store.state;
    this.lines.show(places ? this.found.filter(({ info }) => !this.hidden.has(info)) : [], places ? place : null, ({ info }) => this.colourOf(info), ACCENT[theme]);
  }
}

function groupsOf(places: Place[]): [ClassInfo, Place[]][] {
  const groups = new Map<ClassInfo, Place[]>();
  for (const place of places) groups.set(place.info, [...(groups.get(place.info) ?? []), place]);
  return [...groups].sort(([a, some], [b, others]) => others.length - some.length || (a.label < b.label ? -1 : 1));
}

/** A corner of a line, else the middle; its height is the ground's. */
export function middleOfPlace({ kind, corners }: Place): number[] {
  if (kind !== 'outline') return corners[Math.floor(corners.length / 2)];
  const xs = corners.map(([x]) => x), ys = corners.map(([, y]) => y);
  return [0.5 * (Math.min(...xs) + Math.max(...xs)), 0.5 * (Math.min(...ys) + Math.max(...ys))];
}
