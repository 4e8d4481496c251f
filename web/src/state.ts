// SPDX-License-Identifier: Apache-2.0
// What the page shows, in one place: panels change it and are told of changes.
import type { MapObject } from './data/model';
import type { ColourMode } from './scene/materials';

/** The objects of an answer, in the order of its rows. */
export interface Lit { objects: MapObject[]; ranked: boolean }

export interface PageState {
  selected: MapObject | null;
  /** null: nothing is asked, all objects are plain. */
  lit: Lit | null;
  colourMode: ColourMode;
  /** IRIs; '' stands for points without an object. */
  hiddenClasses: Set<string>;
  boxes: boolean;
  sensorPath: boolean;
  measuring: boolean;
  /** Heights above the ground that are shown [m]; null: all. */
  slice: [number, number] | null;
  /** The first and the last scan that is shown, in the order of time; null: all. */
  scans: [number, number] | null;
  theme: 'light' | 'dark';
}

type Listener = (state: PageState, changed: keyof PageState) => void;

export class Store {
  private readonly listeners: Listener[] = [];

  constructor(readonly state: PageState) {}

  on(changed: (keyof PageState)[] | 'any', call: (state: PageState) => void): void {
    this.listeners.push((state, key) => {
      if (changed === 'any' || changed.includes(key)) call(state);
    });
  }

  set<K extends keyof PageState>(key: K, value: PageState[K]): void {
    if (this.state[key] === value) return;
    this.state[key] = value;
    for (const listener of this.listeners) listener(this.state, key);
  }
}
