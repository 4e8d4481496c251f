// SPDX-License-Identifier: Apache-2.0
// The part of the address behind "#" holds camera, selection and question, so that a link shows the same again.
import * as THREE from 'three';
import { MAP, type MapModel } from './data/model';
import type { Viewer } from './scene/viewer';
import type { Store } from './state';

/** What an address says of the question: a shipped one by its file name, or its text. */
export interface AddressQuestion { file?: string; text?: string }

export class Address {
  private pending = 0;
  question: AddressQuestion = {};

  constructor(private readonly viewer: Viewer, private readonly store: Store, private readonly model: MapModel) {
    viewer.onMove.push(() => this.schedule());
    store.on(['selected', 'place'], () => this.schedule());
  }

  setQuestion(question: AddressQuestion): void {
    this.question = question;
    this.schedule();
  }

  /** Applies camera and selection of the address; returns its question, and its place as an IRI. False camera: there was none. */
  restore(): { hasCamera: boolean; question: AddressQuestion; place: string } {
    const values = new URLSearchParams(location.hash.slice(1));
    const camera = (values.get('camera') ?? '').split(',').map(Number);
    const hasCamera = camera.length === 6 && camera.every(Number.isFinite);
    if (hasCamera) {
      const { origin, controls } = this.viewer;
      this.viewer.camera.position.set(camera[0], camera[1], camera[2]).sub(origin);
      controls.target.copy(new THREE.Vector3(camera[3], camera[4], camera[5]).sub(origin));
      controls.update();
      this.viewer.moved();
    }
    const selected = this.model.objectStartingWith(values.get('object') ?? '');
    if (selected) this.store.set('selected', selected);
    const place = /^\w+\/[0-9a-f]{32}$/.test(values.get('place') ?? '') ? MAP + values.get('place') : '';
    return { hasCamera, place, question: { file: values.get('question') ?? undefined, text: values.get('query') ?? undefined } };
  }

  private schedule(): void {
    window.clearTimeout(this.pending);
    this.pending = window.setTimeout(() => this.write(), 250);
  }

  private write(): void {
    const { camera, controls, origin } = this.viewer, values = new URLSearchParams();
    const numbers = [...camera.position.clone().add(origin).toArray(), ...controls.target.clone().add(origin).toArray()];
    values.set('camera', numbers.map((value) => value.toFixed(2)).join(','));
    if (this.store.state.selected) values.set('object', this.store.state.selected.id.slice(0, 12));
    if (this.store.state.place) values.set('place', this.store.state.place.iri.slice(MAP.length));
    if (this.question.file) values.set('question', this.question.file);
    else if (this.question.text) values.set('query', this.question.text);
    history.replaceState(null, '', `#${values.toString().replaceAll('%2C', ',').replaceAll('%2F', '/')}`);
  }
}
