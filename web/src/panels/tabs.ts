// SPDX-License-Identifier: Apache-2.0
// Panels that share a place: one is shown. Arrow keys walk through the tabs.
import { el } from '../dom';

export interface Tab { id: string; label: string; element: HTMLElement }

export class Tabs {
  readonly element: HTMLElement;
  private readonly buttons: HTMLButtonElement[];

  constructor(private readonly tabs: Tab[]) {
    this.buttons = tabs.map((tab) => {
      tab.element.id = `panel-${tab.id}`;
      tab.element.setAttribute('role', 'tabpanel');
      tab.element.setAttribute('aria-labelledby', `tab-${tab.id}`);
      return el('button', { type: 'button', role: 'tab', id: `tab-${tab.id}`, 'aria-controls': `panel-${tab.id}`,
                            onclick: () => this.show(tab.id), onkeydown: (event: KeyboardEvent) => this.key(event) }, tab.label);
    });
    this.element = el('div', { class: 'tabs', role: 'tablist', 'aria-label': 'Panels' }, ...this.buttons);
    this.show(tabs[0].id);
  }

  show(id: string): void {
    this.tabs.forEach((tab, i) => {
      const isShown = tab.id === id;
      tab.element.hidden = !isShown;
      this.buttons[i].setAttribute('aria-selected', String(isShown));
      this.buttons[i].tabIndex = isShown ? 0 : -1;
    });
  }

  private key(event: KeyboardEvent): void {
    const by = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (by === 0) return;
    const at = this.buttons.indexOf(event.currentTarget as HTMLButtonElement);
    const next = (at + by + this.tabs.length) % this.tabs.length;
    this.show(this.tabs[next].id);
    this.buttons[next].focus();
    event.preventDefault();
    event.stopPropagation();
  }
}
