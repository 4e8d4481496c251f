// SPDX-License-Identifier: Apache-2.0
// Measures between two points of the cloud: distance, distance in the plane, difference of heights.
import * as THREE from 'three';
import { el, rounded } from '../dom';
import type { Store } from '../state';
import type { Viewer } from './viewer';

export class Measure {
  private readonly line = new THREE.Line(new THREE.BufferGeometry(),
                                         new THREE.LineBasicMaterial({ color: '#e8590c', depthTest: false }));
  private readonly marks = new THREE.Points(new THREE.BufferGeometry(),
                                            new THREE.PointsMaterial({ color: '#e8590c', size: 9, sizeAttenuation: false, depthTest: false }));
  private readonly box = el('output', { class: 'measure', hidden: true });
  private places: THREE.Vector3[] = [];

  constructor(private readonly viewer: Viewer, store: Store) {
    viewer.host.append(this.box);
    for (const item of [this.line, this.marks]) {
      item.frustumCulled = false;
      viewer.overlay.add(item);
    }
    store.on(['measuring'], (state) => this.begin(state.measuring));
    this.begin(false);
  }

  add(place: THREE.Vector3): void {
    if (this.places.length === 2) this.places = [];
    this.places.push(place);
    this.show();
  }

  private begin(on: boolean): void {
    this.places = [];
    this.box.hidden = !on;
    this.show();
  }

  private show(): void {
    for (const item of [this.line, this.marks]) {
      item.geometry.dispose();
      item.geometry = new THREE.BufferGeometry().setFromPoints(this.places);
      item.visible = this.places.length > 0;
    }
    this.box.replaceChildren(...this.text());
    this.viewer.refreshOverlay();
  }

  private text(): Node[] {
    if (this.places.length < 2)
      return [document.createTextNode(this.places.length === 0 ? 'Click a first point.' : 'Click a second point.')];
    const [a, b] = this.places, plane = Math.hypot(a.x - b.x, a.y - b.y);
    const row = (name: string, value: number) =>
      el('span', { class: 'measure-value' }, `${name} `, el('b', {}, `${rounded(value, 2)} m`));
    return [row('Distance', a.distanceTo(b)), row('In plan', plane), row('Height', Math.abs(a.z - b.z))];
  }
}
