// SPDX-License-Identifier: Apache-2.0
// Marks over the 3D view: numbered pins of an answer and the label of the selected object.
import * as THREE from 'three';
import { el } from '../dom';
import { nameOf, type MapObject } from '../data/model';
import type { Mark, Store } from '../state';
import type { Viewer } from './viewer';

const MOST_PINS = 60;

interface Pin { element: HTMLElement; place: THREE.Vector3 }

export class Pins {
  private readonly layer = el('div', { class: 'pins', 'aria-hidden': 'true' });
  private pins: Pin[] = [];

  constructor(private readonly viewer: Viewer, private readonly store: Store) {
    viewer.host.append(this.layer);
    store.on(['lit', 'selected', 'marks'], () => this.rebuild());
    viewer.onMove.push(() => this.place());
    viewer.onFrame.push(() => this.place());
  }

  private rebuild(): void {
    const { lit, selected } = this.store.state;
    this.pins = [];
    if (lit?.ranked)
      lit.objects.slice(0, MOST_PINS).forEach((object, i) => {
        if (object !== selected) this.add(object, String(i + 1), 'pin');
      });
    for (const mark of this.store.state.marks.slice(0, MOST_PINS)) this.addMark(mark);
    if (selected) this.add(selected, nameOf(selected), 'pin pin-selected');
    this.layer.replaceChildren(...this.pins.map((pin) => pin.element));
    this.place();
  }

  private add(object: MapObject, text: string, style: string): void {
    const { box } = object;
    const place = new THREE.Vector3(box.x, box.y, box.z + 0.5 * box.height + 0.3).sub(this.viewer.origin);
    const element = el('button', { type: 'button', class: style, tabindex: -1, title: nameOf(object),
                                   onclick: () => this.store.set('selected', object) }, text);
    this.pins.push({ element, place });
  }

  private addMark({ text, title, place: [x, y, z] }: Mark): void {
    const place = new THREE.Vector3(x, y, z ?? this.viewer.origin.z).sub(this.viewer.origin);
    this.pins.push({ element: el('span', { class: 'pin pin-mark', title }, text), place });
  }

  private place(): void {
    const { host, camera } = this.viewer, at = new THREE.Vector3();
    for (const pin of this.pins) {
      at.copy(pin.place).project(camera);
      const isSeen = at.z < 1 && Math.abs(at.x) < 1.05 && Math.abs(at.y) < 1.05;
      pin.element.hidden = !isSeen;
      const x = (0.5 + 0.5 * at.x) * host.clientWidth, y = (0.5 - 0.5 * at.y) * host.clientHeight;
      pin.element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -100%)`;
    }
  }
}
