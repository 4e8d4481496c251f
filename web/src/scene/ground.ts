// SPDX-License-Identifier: Apache-2.0
// The height of the ground at a place, from the points of the coarsest level: marks stand on it.
import type { MapModel } from '../data/model';
import type { Viewer } from './viewer';

const CELL_M = 2, FARTHEST_CELLS = 6;

export class GroundHeights {
  private cells = new Map<string, { sum: number; count: number }>();
  private tilesRead = 0;

  constructor(private readonly viewer: Viewer, private readonly model: MapModel) {}

  /** The mean of the nearest cell with points [m, map]; the middle of the map where there is none. */
  at(x: number, y: number): number {
    this.readTiles();
    const column = Math.floor(x / CELL_M), row = Math.floor(y / CELL_M);
    for (let reach = 0; reach <= FARTHEST_CELLS; ++reach) {
      let sum = 0, count = 0;
      for (let i = -reach; i <= reach; ++i)
        for (let k = -reach; k <= reach; ++k) {
          const cell = this.cells.get(`${column + i},${row + k}`);
          if (cell) { sum += cell.sum; count += cell.count; }
        }
      if (count > 0) return sum / count;
    }
    return this.viewer.origin.z;
  }

  private readTiles(): void {
    const { quantum, lowestHeight, heightStep } = this.model.values;
    for (; this.tilesRead < this.viewer.tiles.length; ++this.tilesRead) {
      const { info, buffer, levels } = this.viewer.tiles[this.tilesRead];
      const shorts = new Uint16Array(buffer), bytes = new Uint8Array(buffer);
      for (let i = 0; i < levels[1]; ++i) {
        const height = bytes[16 * i + 13];
        if (height === 0 || height === 255) continue;  // beyond the range of the byte
        const x = info.origin[0] + quantum * shorts[8 * i], y = info.origin[1] + quantum * shorts[8 * i + 1];
        const z = info.origin[2] + info.zQuantum * shorts[8 * i + 2] - (lowestHeight + heightStep * height);
        const key = `${Math.floor(x / CELL_M)},${Math.floor(y / CELL_M)}`, cell = this.cells.get(key);
        if (cell) { cell.sum += z; ++cell.count; } else this.cells.set(key, { sum: z, count: 1 });
      }
    }
  }
}
