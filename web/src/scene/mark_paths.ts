// SPDX-License-Identifier: Apache-2.0
// The ways of marks as lines over the points, a little above the ground; and their boxes.
import * as THREE from 'three';
import type { Store } from '../state';
import { BoxLines } from './boxes';
import type { GroundHeights } from './ground';
import { fill, piecesOf, thickLines } from './thick_lines';
import type { Viewer } from './viewer';

const COLOURS = ['#e8590c', '#7048e8', '#0c8599', '#c2255c'];
const ABOVE_GROUND_M = 0.3, PATH_PIXELS = 4;

export class MarkPaths {
  private readonly lines = thickLines(PATH_PIXELS, 0.9, false);
  private readonly boxes: BoxLines;

  constructor(private readonly viewer: Viewer, private readonly store: Store, private readonly ground: GroundHeights) {
    this.boxes = new BoxLines(viewer.origin, 0.9, true);
    viewer.overlay.add(this.lines, this.boxes.lines);
    store.on(['marks'], () => this.rebuild());
  }

  private rebuild(): void {
    const paths = this.store.state.marks.flatMap((mark) => (mark.path && mark.path.length > 1 ? [mark.path] : []));
    const colourOf = (path: number) => COLOURS[this.isTour(paths) ? 0 : path % COLOURS.length];
    const pieces = paths.flatMap((path, i) => piecesOf(path).map(([from, to]) => ({ from: this.onGround(from), to: this.onGround(to), colour: colourOf(i) })));
    fill(this.lines, pieces, pieces.map(({ colour }) => colour));
    this.boxes.set(this.store.state.marks.flatMap((mark) => mark.boxes ?? []).map(({ min, max }) => ({ color: COLOURS[0], box: {
      x: 0.5 * (min[0] + max[0]), y: 0.5 * (min[1] + max[1]), z: 0.5 * (min[2] + max[2]),
      length: max[0] - min[0], width: max[1] - min[1], height: max[2] - min[2], yaw: 0,
    } })));
    this.viewer.refreshOverlay();
  }

  /** Each path begins where the one before it ends. */
  private isTour(paths: number[][][]): boolean {
    return paths.every((path, i) => i === 0 || path[0].every((value, axis) => value === paths[i - 1].at(-1)![axis]));
  }

  private onGround([x, y]: number[]): THREE.Vector3 {
    return new THREE.Vector3(x, y, this.ground.at(x, y) + ABOVE_GROUND_M).sub(this.viewer.origin);
  }
}
