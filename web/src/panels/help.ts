// SPDX-License-Identifier: Apache-2.0
// A dialog with the keys, what the page does, and the licences of what it is made of.
import { blockText } from '../data/blocks';
import type { MapModel } from '../data/model';
import { counted, el, iconButton } from '../dom';
import type { Command } from './toolbar';

export class Help {
  readonly element = el('dialog', { class: 'help', 'aria-label': 'Help' });
  private licences: Promise<string> | undefined;

  constructor(private readonly model: MapModel) {}

  show(commands: Command[]): void {
    const close = iconButton('close', 'Close', () => this.element.close());
    const texts = el('pre', { tabindex: 0 });
    const keys = commands.map(({ key, label }) => el('tr', {}, el('th', { scope: 'row' }, el('kbd', {}, key.toUpperCase())), el('td', {}, label)));
    this.element.replaceChildren(
      el('header', {}, el('h2', {}, 'Help'), close),
      el('p', {}, `${this.model.values.name}: ${counted(this.model.values.pointsInMap)} points from ${counted(this.model.values.clouds.length)} scans, ${counted(this.model.objects.length)} objects. ${this.model.values.served ? 'Its service answers tasks, tries rules and takes statements.' : 'This file holds all of it and asks no server.'}`),
      el('p', {}, 'Drag turns the view, the right button or Shift moves it, the wheel zooms. A click on a point selects its object. With the view focused, arrow keys move it.'),
      el('table', { class: 'keys' }, el('tbody', {}, ...keys,
         el('tr', {}, el('th', { scope: 'row' }, el('kbd', {}, 'Ctrl Enter')), el('td', {}, 'Ask the question in the editor')),
         el('tr', {}, el('th', { scope: 'row' }, el('kbd', {}, 'Ctrl Space')), el('td', {}, 'Complete a name in the editor')),
         el('tr', {}, el('th', { scope: 'row' }, el('kbd', {}, 'Esc')), el('td', {}, 'Close the card, then the answer')))),
      el('details', { ontoggle: () => void this.fillLicences(texts) }, el('summary', {}, 'Licences of what this page is made of'),
         el('p', {}, 'Cluxel: Apache License 2.0. The rest:'), texts));
    this.element.showModal();
  }

  private async fillLicences(host: HTMLElement): Promise<void> {
    this.licences ??= blockText('licences');
    host.textContent = await this.licences;
  }
}
