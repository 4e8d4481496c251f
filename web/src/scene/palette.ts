// SPDX-License-Identifier: Apache-2.0
// One texel for each object: its colour, and in alpha whether it is hidden, dimmed, plain or lit. Texel 0 stands for
// points without an object. An answer lights up by changing texels; no point is touched.
import * as THREE from 'three';
import type { MapModel, MapObject } from '../data/model';

const WIDTH = 256;
const HIDDEN = 0, DIMMED = 85, PLAIN = 170, LIT = 255;
const NO_OBJECT: [number, number, number] = [128, 128, 128];

export type Rgb = [number, number, number];

export function rgbOf(hex: string): Rgb {
  const value = /^#[0-9a-f]{6}$/i.test(hex) ? parseInt(hex.slice(1), 16) : 0x808080;
  return [value >> 16, (value >> 8) & 255, value & 255];
}

/** Red (unsure) over yellow to blue (sure): apart for all kinds of colour sight. */
export function certaintyColour(confidence: number): Rgb {
  const stops: Rgb[] = [[202, 70, 48], [244, 190, 98], [120, 170, 206], [38, 92, 160]];
  const at = Math.min(1, Math.max(0, (confidence - 0.3) / 0.7)) * (stops.length - 1);
  const low = Math.min(stops.length - 2, Math.floor(at)), share = at - low;
  return stops[low].map((value, i) => Math.round(value + (stops[low + 1][i] - value) * share)) as Rgb;
}

export class Palette {
  readonly texture: THREE.DataTexture;
  private readonly data: Uint8Array;
  private byCertainty = false;
  private hiddenClasses = new Set<string>();
  private lit: Set<number> | null = null;

  constructor(private readonly model: MapModel) {
    const height = Math.max(1, Math.ceil((model.objects.length + 1) / WIDTH));
    this.data = new Uint8Array(WIDTH * height * 4);
    this.texture = new THREE.DataTexture(this.data, WIDTH, height, THREE.RGBAFormat, THREE.UnsignedByteType);
    this.refresh();
  }

  get width(): number {
    return WIDTH;
  }

  setCertainty(on: boolean): void {
    this.byCertainty = on;
    this.refresh();
  }

  /** Classes by IRI; '' stands for points without an object. */
  hideClasses(hidden: Set<string>): void {
    this.hiddenClasses = new Set(hidden);
    this.refresh();
  }

  isHidden(object: MapObject): boolean {
    return this.hiddenClasses.has(object.class.iri);
  }

  /** Lights up these objects and dims the others; null: all are plain. */
  light(objects: MapObject[] | null): void {
    this.lit = objects && new Set(objects.map((object) => object.number));
    this.refresh();
  }

  private refresh(): void {
    const other = this.lit ? DIMMED : PLAIN;
    this.set(0, NO_OBJECT, this.hiddenClasses.has('') ? HIDDEN : other);
    for (const object of this.model.objects) {
      const colour = this.byCertainty ? certaintyColour(object.confidence) : rgbOf(object.class.color);
      const state = this.isHidden(object) ? HIDDEN : this.lit?.has(object.number) ? LIT : other;
      this.set(object.number + 1, colour, state);
    }
    this.texture.needsUpdate = true;
  }

  private set(texel: number, colour: Rgb, state: number): void {
    this.data.set([...colour, state], 4 * texel);
  }
}
