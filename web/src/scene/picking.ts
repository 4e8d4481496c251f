// SPDX-License-Identifier: Apache-2.0
// Which point is under the pointer: the points around it are drawn as numbers into a few pixels.
import * as THREE from 'three';
import type { MapModel, MapObject } from '../data/model';
import { pointAt } from './cloud_tiles';
import { LevelOfDetail } from './level_of_detail';
import { pickMaterial } from './materials';
import type { Viewer } from './viewer';

const SIZE = 9;

export interface Pick {
  object: MapObject | undefined;
  /** In the scene [m]. */
  place: THREE.Vector3;
}

export class Picking {
  private readonly target = new THREE.WebGLRenderTarget(SIZE, SIZE, {
    format: THREE.RGBAIntegerFormat, type: THREE.UnsignedIntType, internalFormat: 'RGBA32UI',
    minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: true,
  });
  private readonly material: THREE.ShaderMaterial;
  private readonly camera = new THREE.PerspectiveCamera();

  constructor(private readonly viewer: Viewer, private readonly model: MapModel) {
    this.material = pickMaterial(viewer.uniforms);
  }

  /** `x` and `y` in CSS pixels from the canvas's corner. */
  at(x: number, y: number): Pick | undefined {
    const nearest = this.nearestOf(this.drawn(x, y));
    if (!nearest) return undefined;
    const tile = this.viewer.tiles.find((candidate) => candidate.number === nearest.tile);
    if (!tile) return undefined;
    return { object: this.model.objects[nearest.object - 1], place: pointAt(tile, nearest.vertex) };
  }

  private drawn(x: number, y: number): Uint32Array {
    const { renderer, cloud, tiles, host, uniforms } = this.viewer;
    const ratio = uniforms.pixelRatio.value, half = (SIZE - 1) / 2;
    this.camera.copy(this.viewer.camera);
    this.camera.setViewOffset(host.clientWidth * ratio, host.clientHeight * ratio, Math.floor(x * ratio) - half,
                              Math.floor(y * ratio) - half, SIZE, SIZE);
    this.camera.updateMatrixWorld();
    LevelOfDetail.showAll(tiles);
    const restore: (() => void)[] = [];
    for (const tile of tiles) {
      const forPicture = tile.points.onBeforeRender;
      restore.push(() => {
        tile.points.material = this.viewer.material;
        tile.points.onBeforeRender = forPicture;
      });
      tile.points.material = this.material;
      tile.points.onBeforeRender = () => {
        this.material.uniforms.tile.value = tile.number;
        uniforms.spread.value = tile.spread;
        this.material.uniformsNeedUpdate = true;
      };
    }
    renderer.setRenderTarget(this.target);
    renderer.clear();
    renderer.render(cloud, this.camera);
    for (const call of restore) call();
    const pixels = new Uint32Array(4 * SIZE * SIZE), gl = renderer.getContext() as WebGL2RenderingContext;
    gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA_INTEGER, gl.UNSIGNED_INT, pixels);
    renderer.setRenderTarget(null);
    return pixels;
  }

  /** The hit nearest to the middle. */
  private nearestOf(pixels: Uint32Array): { object: number; tile: number; vertex: number } | undefined {
    const half = (SIZE - 1) / 2;
    let best = Infinity, at = -1;
    for (let i = 0; i < SIZE * SIZE; ++i) {
      if (pixels[4 * i + 1] === 0) continue;
      const distance = ((i % SIZE) - half) ** 2 + (Math.floor(i / SIZE) - half) ** 2;
      if (distance < best) [best, at] = [distance, i];
    }
    return at < 0 ? undefined : { object: pixels[4 * at], tile: pixels[4 * at + 1] - 1, vertex: pixels[4 * at + 2] };
  }
}
