// SPDX-License-Identifier: Apache-2.0
// Chooses which levels of which tiles a frame draws: coarse and near ones first, as many points as the machine draws in
// a frame. While the camera rests, further frames add what is missing.
import * as THREE from 'three';
import type { Tile } from './cloud_tiles';

interface Job { tile: Tile; level: number; urgency: number }

const SLOW_MS = 40, FAST_MS = 28;
const LEAST_BUDGET = 15_000, LARGEST_BUDGET = 30_000_000;
const MOST_AROUND = 200_000;

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
    const frustum = frustumOf(camera);
    this.next = 0;
    this.jobs = tiles.flatMap((tile) => jobsOf(tile, frustum, camera)).sort((a, b) => a.urgency - b.urgency);
  }

  /** Goes on with the picture and one more tile. */
  add(tile: Tile, camera: THREE.PerspectiveCamera): void {
    const left = [...this.jobs.slice(this.next), ...jobsOf(tile, frustumOf(camera), camera)];
    this.next = 0;
    this.jobs = left.sort((a, b) => a.urgency - b.urgency);
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

  /** The points around one object: coarser levels for a large one. All other tiles become invisible. */
  static showAround(tiles: readonly Tile[], around: THREE.Box3): void {
    const near = tiles.filter(({ points }) => points.geometry.boundingBox!.clone().applyMatrix4(points.matrixWorld).intersectsBox(around));
    const pointsTo = (level: number) => near.reduce((sum, tile) => sum + tile.levels[level], 0);
    let level = Math.max(1, ...near.map((tile) => tile.levels.length - 1));
    while (level > 1 && pointsTo(level) > MOST_AROUND) --level;
    for (const tile of tiles) tile.points.visible = false;
    for (const tile of near) {
      tile.points.geometry.setDrawRange(0, tile.levels[level]);
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

function frustumOf(camera: THREE.PerspectiveCamera): THREE.Frustum {
  return new THREE.Frustum().setFromProjectionMatrix(
    new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
}

/** The levels of a tile that the camera sees. */
function jobsOf(tile: Tile, frustum: THREE.Frustum, camera: THREE.PerspectiveCamera): Job[] {
  if (!frustum.intersectsObject(tile.points)) return [];
  const distance = Math.max(8, tile.center.distanceTo(camera.position)), jobs: Job[] = [];
  for (let level = 0; level + 1 < tile.levels.length; ++level)
    if (tile.levels[level + 1] > tile.levels[level]) jobs.push({ tile, level, urgency: distance * 2 ** level });
  return jobs;
}
