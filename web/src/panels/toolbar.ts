// SPDX-License-Identifier: Apache-2.0
// Buttons over the 3D view, and the keys that do the same.
import { iconButton, el } from '../dom';
import type { Stage } from '../scene/stage';
import type { PageState, Store } from '../state';
import { middleOfPlace } from './places';

export interface Command { key: string; label: string; act(): void }

export class Toolbar {
  readonly element = el('div', { class: 'toolbar', role: 'toolbar', 'aria-label': 'View' });
  readonly commands: Command[];

  constructor(stage: Stage, private readonly store: Store, showHelp: () => void, focusQuestions: () => void) {
    this.commands = [
      { key: 'h', label: 'Show the whole map', act: () => stage.home() },
      { key: 't', label: 'Look from above', act: () => stage.home(true) },
      { key: 'b', label: 'Show boxes of objects', act: () => this.toggle('boxes') },
      { key: 'p', label: 'Show where scans were taken', act: () => this.toggle('sensorPath') },
      { key: 'l', label: 'Show ways and places', act: () => this.toggle('places') },
      { key: 'm', label: 'Measure between two points', act: () => this.toggle('measuring') },
      { key: 'd', label: 'Light or dark', act: () => store.set('theme', store.state.theme === 'dark' ? 'light' : 'dark') },
      { key: 'f', label: 'Go to what is selected', act: () => this.goToSelected(stage) },
      { key: 'n', label: 'Select the next object of the answer', act: () => this.step(stage, 1) },
      { key: 'v', label: 'Select the previous object of the answer', act: () => this.step(stage, -1) },
      { key: 'q', label: 'Go to the questions', act: focusQuestions },
      { key: '?', label: 'Help and licences', act: showHelp },
    ];
    this.element.append(this.button('home', 'h'), this.button('top', 't'), this.button('box', 'b', 'boxes'),
                        this.button('path', 'p', 'sensorPath'), this.button('layers', 'l', 'places'), this.button('ruler', 'm', 'measuring'),
                        this.button('theme', 'd'), this.button('help', '?'));
    document.addEventListener('keydown', (event) => this.key(event));
  }

  private button(name: 'home' | 'top' | 'box' | 'path' | 'layers' | 'ruler' | 'theme' | 'help', key: string, state?: keyof PageState) {
    const command = this.commands.find((candidate) => candidate.key === key)!;
    const made = iconButton(name, `${command.label} (${key.toUpperCase()})`, command.act,
                            { 'aria-pressed': state ? 'false' : undefined });
    if (state) this.store.on([state], (now) => made.setAttribute('aria-pressed', String(now[state])));
    return made;
  }

  private toggle(name: 'boxes' | 'sensorPath' | 'places' | 'measuring'): void {
    this.store.set(name, !this.store.state[name]);
  }

  private goToSelected(stage: Stage): void {
    const { selected, place } = this.store.state;
    if (selected) stage.goTo(selected.box);
    else if (place) stage.goToPlace(middleOfPlace(place));
  }

  /** Walks through the objects of the answer. */
  private step(stage: Stage, by: number): void {
    const objects = this.store.state.lit?.objects;
    if (!objects || objects.length === 0) return;
    const at = this.store.state.selected ? objects.indexOf(this.store.state.selected) : -1;
    const next = objects[(at + by + objects.length + (at < 0 && by < 0 ? 1 : 0)) % objects.length];
    this.store.set('selected', next);
    stage.goTo(next.box);
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    if (target.closest('input:not([type=checkbox]):not([type=range]), textarea, select, .CodeMirror')) return;
    if (event.key === 'Escape') return this.escape();
    const command = this.commands.find((candidate) => candidate.key === event.key.toLowerCase());
    if (!command) return;
    event.preventDefault();
    command.act();
  }

  private escape(): void {
    if (this.store.state.measuring) this.store.set('measuring', false);
    else if (this.store.state.selected) this.store.set('selected', null);
    else if (this.store.state.place) this.store.set('place', null);
    else {
      this.store.set('lit', null);
      this.store.set('marks', []);
      this.store.set('tints', null);
    }
  }
}
