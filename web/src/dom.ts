// SPDX-License-Identifier: Apache-2.0
// Elements from code. Texts become text nodes, so that what a map holds is never read as markup.

type Child = Node | string | null | undefined | false;
interface Attributes {
  class?: string;
  title?: string;
  [name: string]: string | number | boolean | ((event: never) => void) | undefined;
}

/** el('button', { class: 'x', onclick: f, 'aria-label': 'y' }, 'text'): false and undefined leave an attribute out. */
export function el<K extends keyof HTMLElementTagNameMap>(
    name: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(key.slice(2), value as EventListener);
    else element.setAttribute(key, value === true ? '' : String(value));
  }
  for (const child of children) if (child) element.append(child);
  return element;
}

const ICONS: Record<string, string> = {
  home: 'M3 11 12 4l9 7v9h-6v-6H9v6H3z',
  top: 'M4 4h16v16H4zM12 8v8M8 12h8',
  box: 'M12 3 20 7.5v9L12 21l-8-4.5v-9zM4 7.5 12 12l8-4.5M12 12v9',
  ruler: 'M4 16 16 4l4 4L8 20zM8 12l2 2M11 9l2 2M14 6l2 2',
  theme: 'M12 3a9 9 0 1 0 9 9 7 7 0 0 1-9-9z',
  help: 'M9 9a3 3 0 1 1 4 3c-1 .5-1 1-1 2M12 17.5v.5M12 3a9 9 0 1 1 0 18 9 9 0 0 1 0-18z',
  close: 'M6 6l12 12M18 6 6 18',
  run: 'M7 4l13 8-13 8z',
  stop: 'M6 6h12v12H6z',
  aim: 'M12 8a4 4 0 1 1 0 8 4 4 0 0 1 0-8zM12 2v4M12 18v4M2 12h4M18 12h4',
  down: 'M12 4v11M7 11l5 5 5-5M5 20h14',
  path: 'M5 19c4-1 2-8 7-8s3-6 7-7M5 17a2 2 0 1 1 0 4 2 2 0 0 1 0-4zM19 2a2 2 0 1 1 0 4 2 2 0 0 1 0-4z',
  layers: 'M12 4 21 9l-9 5-9-5zM3 14l9 5 9-5',
};

export function icon(name: keyof typeof ICONS): SVGElement {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg'), path = document.createElementNS(space, 'path');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('class', 'icon');
  svg.setAttribute('aria-hidden', 'true');
  path.setAttribute('d', ICONS[name]);
  svg.append(path);
  return svg;
}

export function iconButton(name: keyof typeof ICONS, label: string, act: () => void, more: Attributes = {}) {
  return el('button', { type: 'button', class: 'icon-button', title: label, 'aria-label': label, onclick: act, ...more },
            icon(name));
}

/** A small field of a colour, as CSS writes it. */
export function swatch(colour: string, more = ''): HTMLElement {
  return el('span', { class: `swatch ${more}`.trim(), style: `background:${colour}` });
}

/** What a person is told of a fault. */
export function messageOf(fault: unknown): string {
  return fault instanceof Error ? fault.message : String(fault);
}

export function faultNote(fault: unknown): HTMLElement {
  return el('p', { class: 'note fault', role: 'alert' }, messageOf(fault));
}

const grouped = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });

/** 2102658 as "2,102,658". */
export function counted(value: number): string {
  return grouped.format(value);
}

/** At most three decimals, without trailing zeros. */
export function rounded(value: number, digits = 3): string {
  return String(Number(value.toFixed(digits)));
}
