// SPDX-License-Identifier: Apache-2.0
// Which point is under the pointer: the picture holds the numbers of objects, so a few of its pixels are read.
import * as THREE from 'three';
import type { MapModel, MapObject } from '../data/model';
import { pointNear } from './cloud_tiles';
import { peekMaterial } from './materials';
import type { Store } from '../state';
import type { Viewer } from './viewer';

const SIZE = 9;
/** A stored point lies this near to the place that is seen [m]: points are drawn as squares. */
const REACH_M = 0.6;

export interface Pick {
  object: MapObject | undefined;
  /** Of the stored point, in the scene [m]. */
  place: THREE.Vector3;
}

interface Hit { object: number; place: THREE.Vector3 }

export class Picking {
  private readonly target = new THREE.WebGLRenderTarget(SIZE, SIZE, {
    format: THREE.RGBAIntegerFormat, type: THREE.UnsignedIntType, internalFormat: 'RGBA32UI',
    minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: false,
  });
  private readonly material = peekMaterial();
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);

  constructor(private readonly viewer: Viewer, private readonly model: MapModel, private readonly store: Store) {
    const plane = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.material);
    plane.frustumCulled = false;
    this.scene.add(plane);
  }

  /** `x` and `y` in CSS pixels from the canvas's corner. */
  at(x: number, y: number): Pick | undefined {
    const hit = this.hitAt(x, y);
    if (!hit) return undefined;
    return { object: this.model.objects[hit.object - 1], place: this.storedPoint(hit) ?? hit.place };
  }

  /** What is seen nearest to the middle of the pixels around a place. */
  private hitAt(x: number, y: number): Hit | undefined {
    const { picture, uniforms, camera } = this.viewer, ratio = uniforms.pixelRatio.value, half = (SIZE - 1) / 2;
    const corner = [Math.floor(x * ratio) - half, picture.height - 1 - Math.floor(y * ratio) - half];
    const pixels = this.pixelsFrom(corner), depths = new Float32Array(pixels.buffer);
    let best = Infinity, at = -1;
    for (let i = 0; i < SIZE * SIZE; ++i) {
      if (pixels[4 * i] === 0 || this.isHidden(pixels[4 * i] - 1)) continue;
      const distance = ((i % SIZE) - half) ** 2 + (Math.floor(i / SIZE) - half) ** 2;
      if (distance < best) [best, at] = [distance, i];
    }
    if (at < 0) return undefined;
    const column = corner[0] + (at % SIZE) + 0.5, row = corner[1] + Math.floor(at / SIZE) + 0.5;
    const place = new THREE.Vector3((2 * column) / picture.width - 1, (2 * row) / picture.height - 1, 2 * depths[4 * at + 1] - 1);
    return { object: pixels[4 * at] - 1, place: place.unproject(camera) };
  }

  /** True of what was hidden after the picture was drawn. `object`: number + 1. */
  private isHidden(object: number): boolean {
    const { palette } = this.viewer, known = this.model.objects[object - 1];
    return known ? palette.isHidden(known) : this.store.state.hiddenClasses.has('');
  }

  private pixelsFrom([column, row]: number[]): Uint32Array {
    const { renderer, picture } = this.viewer, { uniforms } = this.material, pixels = new Uint32Array(4 * SIZE * SIZE);
    uniforms.marks.value = picture.texture;
    uniforms.depths.value = picture.depthTexture;
    (uniforms.corner.value as THREE.Vector2).set(column, row);
    renderer.setRenderTarget(this.target);
    renderer.render(this.scene, this.camera);
    renderer.readRenderTargetPixels(this.target, 0, 0, SIZE, SIZE, pixels);
    renderer.setRenderTarget(null);
    return pixels;
  }

  private storedPoint({ object, place }: Hit): THREE.Vector3 | undefined {
    const near = this.viewer.tiles.map((tile) => pointNear(tile, object, place, REACH_M)).filter((found) => found !== undefined);
    return near.sort((a, b) => a.distanceTo(place) - b.distanceTo(place))[0];
  }
}
