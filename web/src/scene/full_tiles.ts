// SPDX-License-Identifier: Apache-2.0
// Where a page shows a sample of its map, all points of the tiles near the camera come from the service. Tiles that are far
// again go back to the sample, so that memory stays bounded.
import type { MapModel } from '../data/model';
import type { Service } from '../data/service';
import { fetchTile, type Tile } from './cloud_tiles';
import type { Viewer } from './viewer';

/** The camera rests so long before points are asked for [ms]. */
const REST_MS = 250;
/** Tiles are wanted up to this distance from the camera [m]. */
const REACH_M = 60;
/** At most so many points beyond the sample are held. */
const MOST_POINTS = 12_000_000;

export class FullTiles {
  /** By number of the tile: the sample that it replaces. */
  private readonly samples = new Map<number, Tile>();
  private readonly failed = new Set<number>();
  private timer = 0;
  private isBusy = false;
  private points = 0;
  /** Called when more or fewer points are held, with their number and a fault. */
  onChange: (points: number, fault?: string) => void = () => {};

  constructor(private readonly viewer: Viewer, private readonly model: MapModel, private readonly service: Service) {
    viewer.onMove.push(() => this.soon());
  }

  /** Looks for tiles near the camera when it has rested. */
  soon(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => { void this.load(); }, REST_MS);
  }

  private async load(): Promise<void> {
    if (this.isBusy) return;
    this.isBusy = true;
    try {
      for (let tile = this.nearest(); tile; tile = this.nearest()) await this.complete(tile);
    } finally {
      this.isBusy = false;
    }
  }

  private distance(tile: Tile): number {
    return tile.center.distanceTo(this.viewer.camera.position);
  }

  /** The nearest tile of which only a sample is shown. */
  private nearest(): Tile | undefined {
    const near = this.viewer.tiles.filter((tile) =>
      !this.samples.has(tile.number) && !this.failed.has(tile.number) && this.distance(tile) < REACH_M);
    return near.sort((a, b) => this.distance(a) - this.distance(b))[0];
  }

  private async complete(sample: Tile): Promise<void> {
    try {
      const full = await fetchTile(this.model, this.service, sample.number, this.viewer.origin, this.viewer.material);
      this.samples.set(sample.number, sample);
      this.points += countOf(full) - countOf(sample);
      this.viewer.replaceTile(sample, full);
      this.dropFarthest(sample.number);
      this.onChange(this.points);
    } catch (fault) {
      this.failed.add(sample.number);
      this.onChange(this.points, fault instanceof Error ? fault.message : String(fault));
    }
  }

  /** Goes back to samples while too many points are held; never of the tile `kept`. */
  private dropFarthest(kept: number): void {
    const full = this.viewer.tiles.filter(({ number }) => this.samples.has(number) && number !== kept);
    full.sort((a, b) => this.distance(b) - this.distance(a));
    for (const tile of full) {
      if (this.points <= MOST_POINTS) return;
      const sample = this.samples.get(tile.number)!;
      this.samples.delete(tile.number);
      this.points -= countOf(tile) - countOf(sample);
      this.viewer.replaceTile(tile, sample);
      tile.points.geometry.dispose();
    }
  }
}

function countOf(tile: Tile): number {
  return tile.levels[tile.levels.length - 1];
}
