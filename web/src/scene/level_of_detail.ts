// SPDX-License-Identifier: Apache-2.0
// Chooses which levels of which tiles a frame draws: coarse and near ones first, as many points as the machine draws in
// a frame. While the camera rests, further frames add what is missing.
import * as THREE from 'three';
import type { Tile } from './cloud_tiles';

interface Job { tile: Tile; level: number; urgency: number }

const SLOW_MS = 50, FAST_MS = 28;
const LEAST_BUDGET = 15_000, LARGEST_BUDGET = 30_000_000;

export class LevelOfDetail {
  private jobs: Job[] = [];
  private next = 0;
  private budget = 150_000;

  get isDone(): boolean {
    return this.next >= this.jobs.length;
  }

  /** Points of the first frame after a change. */
  get pointsInFrame(): number {
    return this.budget;
  }

  /** Begins the picture anew with the tiles that the camera sees. */
  restart(tiles: readonly Tile[], camera: THREE.PerspectiveCamera): void {
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    this.jobs = [];
    for (const tile of tiles) {
      if (!frustum.intersectsObject(tile.points)) continue;
      const distance = Math.max(8, tile.center.distanceTo(camera.position));
      for (let level = 0; level + 1 < tile.levels.length; ++level)
        if (tile.levels[level + 1] > tile.levels[level])
          this.jobs.push({ tile, level, urgency: distance * 2 ** level });
    }
    this.jobs.sort((a, b) => a.urgency - b.urgency);
    this.next = 0;
  }

  /** Sets the draw ranges for one frame; all other tiles become invisible. Returns the number of points. */
  prepareFrame(tiles: readonly Tile[]): number {
    for (const tile of tiles) tile.points.visible = false;
    let points = 0;
    while (!this.isDone && points < this.budget) {
      const { tile, level } = this.jobs[this.next++];
      const from = tile.levels[level], to = tile.levels[level + 1], range = tile.points.geometry.drawRange;
      if (tile.points.visible) range.count = to - range.start;
      else tile.points.geometry.setDrawRange(from, to - from);
      tile.points.visible = true;
      points += to - from;
    }
    return points;
  }

  /** All points of all tiles, for picking. */
  static showAll(tiles: readonly Tile[]): void {
    for (const tile of tiles) {
      tile.points.geometry.setDrawRange(0, tile.levels[tile.levels.length - 1]);
      tile.points.visible = true;
    }
  }

  /** Learns from the time between two frames that drew `points`. */
  learn(milliseconds: number, points: number): void {
    if (points < 0.5 * this.budget) return;
    if (milliseconds > SLOW_MS) this.budget = Math.max(LEAST_BUDGET, this.budget * 0.75);
    if (milliseconds < FAST_MS) this.budget = Math.min(LARGEST_BUDGET, this.budget * 1.2);
  }
}
