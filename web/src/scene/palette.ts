// SPDX-License-Identifier: Apache-2.0
// One texel for each object: its colour, and in alpha whether it is hidden, dimmed, plain or lit. Texel 0 stands for
// points without an object. An answer is highlighted by changing texels; the points stay as they are.
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

/** As CSS writes it. */
export function cssOf(colour: Rgb): string {
  return `rgb(${colour.join(', ')})`;
}

/** The colours of Okabe and Ito, which stay apart without red or green cones, for the most frequent classes. */
export const DISTINCT: Rgb[] = [
  [0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [213, 94, 0], [240, 228, 66],
];

/** Red (unsure) over yellow to blue (sure): apart for all kinds of colour sight. */
export function certaintyColour(confidence: number): Rgb {
  const stops: Rgb[] = [[202, 70, 48], [244, 190, 98], [120, 170, 206], [38, 92, 160]];
  const at = Math.min(1, Math.max(0, (confidence - 0.3) / 0.7)) * (stops.length - 1);
  const low = Math.min(stops.length - 2, Math.floor(at)), share = at - low;
  return stops[low].map((value, i) => Math.round(value + (stops[low + 1][i] - value) * share)) as Rgb;
}

/** What the colours of objects tell. */
/** The i-th of colours that all kinds of sight tell apart: the list again, darker, after its end. */
export function distinctColour(i: number): Rgb {
  const shade = 1 - 0.45 * Math.floor(i / DISTINCT.length);
  return DISTINCT[i % DISTINCT.length].map((value) => Math.round(value * shade)) as Rgb;
}

export type Scheme = 'class' | 'certainty' | 'distinct';

export class Palette {
  readonly texture: THREE.DataTexture;
  private readonly data: Uint8Array;
  private readonly distinct = new Map<string, Rgb>();
  private scheme: Scheme = 'class';
  private hiddenClasses = new Set<string>();
  private lit: Set<number> | null = null;
  private tints: Map<number, Rgb> | null = null;

  constructor(private readonly model: MapModel) {
    // Ground is a backdrop: grey leaves the colours to things that stand on it.
    const things = model.shownClasses.filter(({ info }) => !info.iri.endsWith('#Ground'));
    things.forEach(({ info }, i) => {
      this.distinct.set(info.iri, distinctColour(i));
    });
    const height = Math.max(1, Math.ceil((model.objects.length + 1) / WIDTH));
    this.data = new Uint8Array(WIDTH * height * 4);
    this.texture = new THREE.DataTexture(this.data, WIDTH, height, THREE.RGBAFormat, THREE.UnsignedByteType);
    this.refresh();
  }

  get width(): number {
    return WIDTH;
  }

  /**
   * `lit`: these objects are lit and the others dimmed; null: all are plain. `hiddenClasses`: IRIs; '' stands for points
   * without an object.
   */
  show(look: { scheme: Scheme; lit: MapObject[] | null; hiddenClasses: Set<string>; tints: Map<number, Rgb> | null }): void {
    this.scheme = look.scheme;
    this.hiddenClasses = new Set(look.hiddenClasses);
    this.lit = look.lit && new Set(look.lit.map((object) => object.number));
    this.tints = look.tints;
    this.refresh();
  }

  /** The colour of a class in the scheme that is shown. */
  classColour(iri: string): Rgb {
    if (this.scheme === 'distinct') return this.distinct.get(iri) ?? NO_OBJECT;
    return rgbOf(this.model.classes.get(iri)?.color ?? '');
  }

  /** The colour of an object in the scheme that is shown, without tints. */
  colourOf(object: MapObject): Rgb {
    return this.scheme === 'certainty' ? certaintyColour(object.confidence) : this.classColour(object.class.iri);
  }

  isHidden(object: MapObject): boolean {
    return this.hiddenClasses.has(object.class.iri);
  }

  private refresh(): void {
    const other = this.lit || this.tints ? DIMMED : PLAIN;
    this.set(0, NO_OBJECT, this.hiddenClasses.has('') ? HIDDEN : other);
    for (const object of this.model.objects) {
      const colour = this.colourOf(object);
      const tint = this.tints?.get(object.number), isLit = this.tints ? tint !== undefined : this.lit?.has(object.number);
      const state = this.isHidden(object) ? HIDDEN : isLit ? LIT : other;
      this.set(object.number + 1, tint ?? colour, state);
    }
    this.texture.needsUpdate = true;
  }

  private set(texel: number, colour: Rgb, state: number): void {
    this.data.set([...colour, state], 4 * texel);
  }
}
