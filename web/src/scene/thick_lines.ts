// SPDX-License-Identifier: Apache-2.0
// Lines of a width in pixels, which plain WebGL does not draw.
import * as THREE from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';

const LONGEST_PIECE_M = 3;

/** Ends in the scene [m]. */
export interface Segment { from: THREE.Vector3; to: THREE.Vector3 }

/** `isHidden`: points before the lines hide them. */
export function thickLines(pixels: number, opacity: number, isHidden: boolean): LineSegments2 {
  const material = new LineMaterial({ linewidth: pixels, vertexColors: true, transparent: true, opacity, depthTest: isHidden, depthWrite: false });
  const lines = new LineSegments2(new LineSegmentsGeometry(), material);
  lines.frustumCulled = false;
  lines.visible = false;
  return lines;
}

/** `colours` by segment, as CSS writes them. */
export function fill(lines: LineSegments2, segments: readonly Segment[], colours: string[]): void {
  lines.geometry.dispose();
  lines.geometry = new LineSegmentsGeometry();
  lines.visible = segments.length > 0;
  if (segments.length === 0) return;
  lines.geometry.setPositions(segments.flatMap(({ from, to }) => [...from.toArray(), ...to.toArray()]));
  lines.geometry.setColors(colours.flatMap((name) => {
    const { r, g, b } = new THREE.Color(name);
    return [r, g, b, r, g, b];
  }));
}

/** A line in pieces that are short enough to follow the ground: pairs of places, x and y [m, map]. */
export function piecesOf(corners: number[][]): [number[], number[]][] {
  const made: [number[], number[]][] = [];
  for (let i = 1; i < corners.length; ++i) {
    const [ax, ay] = corners[i - 1], [bx, by] = corners[i];
    const pieces = Math.max(1, Math.ceil(Math.hypot(bx - ax, by - ay) / LONGEST_PIECE_M));
    const at = (k: number) => [ax + ((bx - ax) * k) / pieces, ay + ((by - ay) * k) / pieces];
    for (let k = 0; k < pieces; ++k) made.push([at(k), at(k + 1)]);
  }
  return made;
}
