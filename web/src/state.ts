// SPDX-License-Identifier: Apache-2.0
// What the page shows, in one place: panels change it and are told of changes.
import type { Extent, MapObject } from './data/model';
import type { Place } from './data/places';
import type { ColourMode } from './scene/materials';
import type { Rgb } from './scene/palette';

/** The objects of an answer, in the order of its rows. */
export interface Lit { objects: MapObject[]; ranked: boolean }

/** A place that is marked over the view, with a way that leads there. */
export interface Mark {
  text: string;
  title: string;
  /** x, y and, if it is known, z [m, map]. */
  place: number[];
  path?: number[][];
  /** Boxes to draw, by their corners [m, map]. */
  boxes?: Extent[];
}

export interface PageState {
  selected: MapObject | null;
  /** The selected place; an object and a place are never selected together. */
  place: Place | null;
  /** null: nothing is asked, all objects are plain. */
  lit: Lit | null;
  marks: Mark[];
  /** Colours of objects by number in place of the colour mode's; the others are dimmed. null: none. */
  tints: Map<number, Rgb> | null;
  /** A line of a rule file that a person wants to see. */
  ruleLine: { file: string; line: number } | null;
  colourMode: ColourMode;
  /** IRIs; '' stands for points without an object. */
  hiddenClasses: Set<string>;
  boxes: boolean;
  /** Ways, junctions, regions and the places that rules derive. */
  places: boolean;
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
