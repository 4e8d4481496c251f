// SPDX-License-Identifier: Apache-2.0
// Upright boxes as lines: one buffer for a set of boxes.
import * as THREE from 'three';
import type { Box } from '../data/model';

const EDGES = [0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7, 7, 6, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7];

function cornersOf(box: Box, origin: THREE.Vector3): THREE.Vector3[] {
  const along = new THREE.Vector3(Math.cos(box.yaw), Math.sin(box.yaw), 0);
  const across = new THREE.Vector3(-along.y, along.x, 0);
  const center = new THREE.Vector3(box.x, box.y, box.z).sub(origin);
  return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
    center.clone()
      .addScaledVector(along, (corner & 1 ? 0.5 : -0.5) * Math.max(box.length, 0.05))
      .addScaledVector(across, (corner & 2 ? 0.5 : -0.5) * Math.max(box.width, 0.05))
      .add(new THREE.Vector3(0, 0, (corner & 4 ? 0.5 : -0.5) * Math.max(box.height, 0.05))));
}

export class BoxLines {
  readonly lines: THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial>;

  constructor(private readonly origin: THREE.Vector3, opacity = 1, throughPoints = false) {
    const material = new THREE.LineBasicMaterial({
      vertexColors: true, transparent: true, opacity, depthTest: !throughPoints,
    });
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(), material);
    this.lines.frustumCulled = false;
  }

  set(boxes: { box: Box; color: string }[]): void {
    const positions: number[] = [], colours: number[] = [];
    for (const { box, color } of boxes) {
      const corners = cornersOf(box, this.origin), colour = new THREE.Color(color);
      for (const corner of EDGES) {
        positions.push(...corners[corner].toArray());
        colours.push(colour.r, colour.g, colour.b);
      }
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new THREE.BufferGeometry();
    this.lines.geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
    this.lines.geometry.setAttribute('color', new THREE.Float32BufferAttribute(colours, 3));
  }
}
