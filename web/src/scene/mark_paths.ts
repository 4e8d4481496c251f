// SPDX-License-Identifier: Apache-2.0
// The ways of marks as lines over the points, a little above the ground; and their boxes.
import * as THREE from 'three';
import type { Store } from '../state';
import { BoxLines } from './boxes';
import type { GroundHeights } from './ground';
import type { Viewer } from './viewer';

const COLOURS = ['#e8590c', '#7048e8', '#0c8599', '#c2255c'];
const ABOVE_GROUND_M = 0.3;

export class MarkPaths {
  private readonly lines = new THREE.Group();
  private readonly boxes: BoxLines;

  constructor(private readonly viewer: Viewer, private readonly store: Store, private readonly ground: GroundHeights) {
    this.boxes = new BoxLines(viewer.origin, 0.9, true);
    viewer.overlay.add(this.lines, this.boxes.lines);
    store.on(['marks'], () => this.rebuild());
  }

  private rebuild(): void {
    for (const line of this.lines.children as THREE.Line[]) line.geometry.dispose();
    const paths = this.store.state.marks.flatMap((mark) => (mark.path && mark.path.length > 1 ? [mark.path] : []));
    this.lines.clear();
    paths.forEach((path, i) => {
      const places = path.map(([x, y]) => new THREE.Vector3(x, y, this.ground.at(x, y) + ABOVE_GROUND_M).sub(this.viewer.origin));
      const material = new THREE.LineBasicMaterial({ color: COLOURS[i % COLOURS.length], depthTest: false });
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(places), material);
      line.frustumCulled = false;
      this.lines.add(line);
    });
    this.boxes.set(this.store.state.marks.flatMap((mark) => mark.boxes ?? []).map(({ min, max }) => ({ color: COLOURS[0], box: {
      x: 0.5 * (min[0] + max[0]), y: 0.5 * (min[1] + max[1]), z: 0.5 * (min[2] + max[2]),
      length: max[0] - min[0], width: max[1] - min[1], height: max[2] - min[2], yaw: 0,
    } })));
    this.viewer.refreshOverlay();
  }
}
