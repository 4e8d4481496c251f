// SPDX-License-Identifier: Apache-2.0
// A small picture of one object: its own points, seen from its longer side.
import * as THREE from 'three';
import type { MapObject } from '../data/model';
import { LevelOfDetail } from './level_of_detail';
import type { Viewer } from './viewer';

const WIDTH = 320, HEIGHT = 200;

export class Portrait {
  private readonly target = new THREE.WebGLRenderTarget(WIDTH, HEIGHT);
  private readonly camera = new THREE.OrthographicCamera();

  constructor(private readonly viewer: Viewer) {
    this.camera.up.set(0, 0, 1);
  }

  /** Draws into a canvas that a card holds. */
  drawInto(canvas: HTMLCanvasElement, object: MapObject): void {
    canvas.width = WIDTH;
    canvas.height = HEIGHT;
    const context = canvas.getContext('2d', { willReadFrequently: true }), pixels = this.pixelsOf(object);
    this.colour(pixels, object);
    if (!context) return;
    const image = context.createImageData(WIDTH, HEIGHT);
    for (let row = 0; row < HEIGHT; ++row)   // the first row of a texture is the lowest
      image.data.set(pixels.subarray(4 * WIDTH * (HEIGHT - 1 - row), 4 * WIDTH * (HEIGHT - row)), 4 * WIDTH * row);
    context.putImageData(image, 0, 0);
  }

  private pixelsOf(object: MapObject): Uint8Array {
    const { renderer, cloud, tiles, uniforms } = this.viewer, pixels = new Uint8Array(4 * WIDTH * HEIGHT);
    this.aim(object);
    LevelOfDetail.showAround(tiles, this.boundsOf(object));
    const before = { only: uniforms.only.value, perMetre: uniforms.pixelsPerMetre.value };
    uniforms.only.value = object.number + 1;
    uniforms.pixelsPerMetre.value = 80;
    renderer.setRenderTarget(this.target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(cloud, this.camera);
    renderer.readRenderTargetPixels(this.target, 0, 0, WIDTH, HEIGHT, pixels);
    uniforms.only.value = before.only;
    uniforms.pixelsPerMetre.value = before.perMetre;
    renderer.setRenderTarget(null);
    return pixels;
  }

  /** Marks of points become the colour of the object, shaded by intensity; the rest is clear. */
  private colour(pixels: Uint8Array, object: MapObject): void {
    const colour = this.viewer.palette.colourOf(object);
    for (let i = 0; i < pixels.length; i += 4) {
      const isPoint = pixels[i] + pixels[i + 1] + pixels[i + 2] > 0, shade = 0.74 + (0.42 * pixels[i + 3]) / 255;
      for (const axis of [0, 1, 2]) pixels[i + axis] = isPoint ? Math.min(255, colour[axis] * shade) : 0;
      pixels[i + 3] = isPoint ? 255 : 0;
    }
  }

  private boundsOf({ box }: MapObject): THREE.Box3 {
    const half = 0.5 * Math.hypot(box.length, box.width), center = new THREE.Vector3(box.x, box.y, box.z).sub(this.viewer.origin);
    return new THREE.Box3().setFromCenterAndSize(center, new THREE.Vector3(2 * half, 2 * half, box.height));
  }

  /** From the side on which the object is longer, a little from above. */
  private aim(object: MapObject): void {
    const { box } = object, { camera } = this;
    const center = new THREE.Vector3(box.x, box.y, box.z).sub(this.viewer.origin);
    const side = new THREE.Vector3(-Math.sin(box.yaw), Math.cos(box.yaw), 0.3).normalize();
    const distance = 20 + Math.hypot(box.length, box.width, box.height);
    camera.position.copy(center).addScaledVector(side, distance);
    camera.lookAt(center);
    const tall = 0.55 * (box.height + 0.35 * box.width), wide = 0.55 * box.length;
    const half = Math.max(tall, (wide * HEIGHT) / WIDTH, 0.3);
    camera.top = half;
    camera.bottom = -half;
    camera.right = (half * WIDTH) / HEIGHT;
    camera.left = -camera.right;
    camera.near = 1;
    camera.far = 2 * distance;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }
}
