// SPDX-License-Identifier: Apache-2.0
// What the colours mean, which classes are shown, and which heights.
import { capitalised, type MapModel } from '../data/model';
import { counted, el, rounded, swatch } from '../dom';
import { COLOUR_MODES, type ColourMode } from '../scene/materials';
import type { Palette } from '../scene/palette';
import type { Store } from '../state';

const NAMES: Record<ColourMode, string> = {
  class: 'Class', certainty: 'Certainty', height: 'Height above ground', intensity: 'Intensity', scan: 'Scan',
  primitive: 'Primitive label', coverage: 'Coverage by scans', distinct: 'Class, for all colour sight',
};
const PRIMITIVE_COLOURS = ['#b8a380', '#c75c47', '#fabd29', '#4078d9', '#409957'];

export class Legend {
  readonly element: HTMLElement;
  private readonly scale = el('div', { class: 'scale' });
  private readonly list: HTMLElement;

  constructor(private readonly model: MapModel, private readonly store: Store,
              private readonly palette: Palette, places: HTMLElement) {
    const mode = el('select', { id: 'colour-mode', onchange: () => store.set('colourMode', mode.value as ColourMode) },
                    ...COLOUR_MODES.filter((name) => this.isUseful(name)).map((name) => el('option', { value: name }, NAMES[name])));
    this.list = el('ul', { class: 'classes' }, ...this.classRows());
    this.element = el('details', { class: 'legend', open: !matchMedia('(max-width: 820px)').matches },
                      el('summary', {}, 'Legend'),
                      el('div', { class: 'legend-body' },
                         el('div', { class: 'field' }, el('label', { for: 'colour-mode' }, 'Colour by'), mode), this.scale,
                         this.list, this.heights(), places, this.model.values.clouds.length > 1 && this.scans()));
    store.on(['colourMode', 'hiddenClasses'], () => this.show());
    this.show();
  }

  private isUseful(mode: ColourMode): boolean {
    const { intensity, clouds } = this.model.values;
    if (mode === 'intensity') return intensity[1] > intensity[0];
    return (mode !== 'scan' && mode !== 'coverage') || clouds.length > 1;
  }

  private classRows(): HTMLElement[] {
    const rows = this.model.shownClasses.map(({ info, count }) =>
      this.classRow(info.iri, capitalised(info.label), info.color || '#808080', counted(count), info.comment));
    return [...rows, this.classRow('', 'No object', '#808080', '', 'Points that belong to no object.')];
  }

  private classRow(iri: string, label: string, color: string, count: string, help: string): HTMLElement {
    const toggle = () => {
      const hidden = new Set(this.store.state.hiddenClasses);
      if (!hidden.delete(iri)) hidden.add(iri);
      this.store.set('hiddenClasses', hidden);
    };
    const only = () => this.store.set('hiddenClasses', this.isOnly(iri) ? new Set() : this.allBut(iri));
    const box = el('input', { type: 'checkbox', checked: true, onchange: toggle, 'data-class': iri });
    return el('li', {}, el('label', { title: help || undefined }, box,
                           swatch(color), el('span', { class: 'class-name' }, label)),
              el('span', { class: 'count' }, count),
              el('button', { type: 'button', class: 'only', onclick: only, 'aria-label': `Show only ${label}` }, 'only'));
  }

  private allBut(iri: string): Set<string> {
    return new Set([...this.model.shownClasses.map(({ info }) => info.iri), ''].filter((other) => other !== iri));
  }

  private isOnly(iri: string): boolean {
    const { hiddenClasses } = this.store.state;
    return !hiddenClasses.has(iri) && hiddenClasses.size === this.model.shownClasses.length;
  }

  /** Two sliders cut a slice of heights above the ground. */
  private heights(): HTMLElement {
    const text = el('output', { class: 'count' }, 'all');
    const slider = (id: string, name: string, value: number) =>
      el('input', { type: 'range', id, min: -2, max: 30, step: 0.5, value, 'aria-label': name, oninput: () => {
        const a = Number(low.value), b = Number(high.value), all = a <= -2 && b >= 30;
        text.textContent = all ? 'all' : `${rounded(Math.min(a, b), 1)} to ${rounded(Math.max(a, b), 1)} m`;
        this.store.set('slice', all ? null : [Math.min(a, b), Math.max(a, b)]);
      } });
    const low = slider('slice-low', 'Lowest height above the ground [m]', -2);
    const high = slider('slice-high', 'Greatest height above the ground [m]', 30);
    return el('fieldset', { class: 'heights' }, el('legend', {}, 'Heights above ground ', text), low, high);
  }

  /** Two sliders choose the scans whose points are shown. They follow what else chooses, as the visits do. */
  private scans(): HTMLElement {
    const { clouds } = this.model.values, last = clouds.length - 1, text = el('output', { class: 'count' }, 'all');
    const name = (number: number) => clouds[number].source || String(number + 1);
    const slider = (id: string, label: string, value: number) =>
      el('input', { type: 'range', id, min: 0, max: last, step: 1, value, 'aria-label': label, oninput: () => {
        const [from, to] = chosen();
        this.store.set('scans', from === 0 && to === last ? null : [from, to]);
      } });
    const low = slider('first-scan', 'First scan', 0), high = slider('last-scan', 'Last scan', last);
    const chosen = () => [Math.min(Number(low.value), Number(high.value)), Math.max(Number(low.value), Number(high.value))];
    this.store.on(['scans'], ({ scans }) => {
      const [from, to] = scans ?? [0, last];
      text.textContent = from === 0 && to === last ? 'all' : from === to ? name(from) : `${from + 1} to ${to + 1} of ${last + 1}`;
      if (chosen()[0] === from && chosen()[1] === to) return;  // a slider may have passed the other
      low.value = String(from);
      high.value = String(to);
    });
    return el('fieldset', { class: 'heights' }, el('legend', {}, 'Scans, by time ', text), low, high);
  }

  private show(): void {
    const { colourMode, hiddenClasses } = this.store.state;
    for (const box of this.list.querySelectorAll('input')) {
      const iri = box.dataset.class ?? '';
      box.checked = !hiddenClasses.has(iri);
      (box.nextElementSibling as HTMLElement).style.background = `rgb(${this.palette.classColour(iri).join(' ')})`;
    }
    this.scale.replaceChildren(...this.scaleOf(colourMode));
    this.list.classList.toggle('without-colours', colourMode !== 'class' && colourMode !== 'distinct');
    this.element.querySelector<HTMLSelectElement>('#colour-mode')!.value = colourMode;
  }

  private scaleOf(mode: ColourMode): Node[] {
    const bar = (style: string, low: string, high: string) =>
      [el('div', { class: `bar ${style}` }), el('div', { class: 'ends' }, el('span', {}, low), el('span', {}, high))];
    const { intensity } = this.model.values;
    if (mode === 'certainty') return bar('bar-certainty', 'unsure, 0.3', 'sure, 1');
    if (mode === 'height') return bar('bar-ramp', '0 m', '12 m');
    if (mode === 'intensity') return bar('bar-ramp', rounded(intensity[0], 2), rounded(intensity[1], 2));
    if (mode === 'scan') return bar('bar-ramp', 'first scan', 'last scan');
    if (mode === 'coverage') return bar('bar-ramp', 'seen by 1 scan', '8 or more');
    if (mode !== 'primitive') return [];
    return [el('ul', { class: 'labels' }, ...this.model.values.labels.map((label, i) =>
      el('li', {}, swatch(PRIMITIVE_COLOURS[i]), label.replaceAll('_', ' '))))];
  }
}
