// SPDX-License-Identifier: Apache-2.0
// The ways of marks as lines over the points, a little above the ground.
import * as THREE from 'three';
import type { Store } from '../state';
import type { GroundHeights } from './ground';
import type { Viewer } from './viewer';

const COLOURS = ['#e8590c', '#7048e8', '#0c8599', '#c2255c'];
const ABOVE_GROUND_M = 0.3;

export class MarkPaths {
  private readonly lines = new THREE.Group();

  constructor(private readonly viewer: Viewer, private readonly store: Store, private readonly ground: GroundHeights) {
    viewer.overlay.add(this.lines);
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
    this.viewer.refreshOverlay();
  }
}
