// SPDX-License-Identifier: Apache-2.0
// Places as lines on the ground: ways along their middle, regions and rows as outlines, junctions and crossings as signs.
// What stands before a line hides it, but for a faint trace.
import * as THREE from 'three';
import type { Place } from '../data/places';
import type { GroundHeights } from './ground';
import { fill, piecesOf, thickLines, type Segment } from './thick_lines';
import type { Viewer } from './viewer';

const ABOVE_GROUND_M = 0.3;
const LINE_PIXELS = 3, SELECTED_PIXELS = 7, HIDDEN_OPACITY = 0.28;
/** A click this near to a line means it [CSS pixels]. */
const REACH = 7;
/** A point that lies this much before a line hides it [m]. */
const HIDING_M = 1;

/** Pairs of ends, relative to the place of a junction [m]. */
const JUNCTION = diamond(0.7);
const CROSSING = [...diamond(1.6), [[-0.8, -0.8], [0.8, 0.8]], [[-0.8, 0.8], [0.8, -0.8]]];

interface PlaceSegment extends Segment { place: Place }

export class PlaceLines {
  private readonly seen = thickLines(LINE_PIXELS, 1, true);
  private readonly behind = thickLines(LINE_PIXELS, HIDDEN_OPACITY, false);
  private readonly selected = thickLines(SELECTED_PIXELS, 0.8, false);
  private segments: PlaceSegment[] = [];

  constructor(private readonly viewer: Viewer, private readonly ground: GroundHeights) {
    viewer.overlay.add(this.selected, this.behind, this.seen);
  }

  /** `colourOf`: as CSS writes it. */
  show(places: Place[], selected: Place | null, colourOf: (place: Place) => string, accent: string): void {
    this.segments = places.flatMap((place) => this.segmentsOf(place));
    const colours = this.segments.map(({ place }) => colourOf(place));
    fill(this.seen, this.segments, colours);
    fill(this.behind, this.segments, colours);
    const chosen = selected ? this.segmentsOf(selected) : [];
    fill(this.selected, chosen, chosen.map(() => accent));
    this.viewer.refreshOverlay();
  }

  /** The place under the pointer; `before` is the point of the map that is seen there, if any [scene]. */
  at(x: number, y: number, before: THREE.Vector3 | undefined): Place | undefined {
    const { host, camera } = this.viewer, limit = before ? camera.position.distanceTo(before) + HIDING_M : Infinity;
    const a = new THREE.Vector3(), b = new THREE.Vector3();
    const onScreen = (at: THREE.Vector3) => [(0.5 + 0.5 * at.x) * host.clientWidth, (0.5 - 0.5 * at.y) * host.clientHeight];
    let best = REACH, found: Place | undefined;
    for (const { from, to, place } of this.segments) {
      a.copy(from).project(camera);
      b.copy(to).project(camera);
      if (a.z > 1 || b.z > 1 || camera.position.distanceTo(from) > limit) continue;
      const distance = distanceTo([x, y], onScreen(a), onScreen(b));
      if (distance >= best) continue;
      [best, found] = [distance, place];
    }
    return found;
  }

  private segmentsOf(place: Place): PlaceSegment[] {
    const made: PlaceSegment[] = [];
    if (place.kind === 'mark') {
      const [x, y] = place.corners[0], sign = place.info.iri.endsWith('#Crossing') ? CROSSING : JUNCTION;
      for (const [from, to] of sign)
        made.push({ from: this.onGround([x + from[0], y + from[1]]), to: this.onGround([x + to[0], y + to[1]]), place });
      return made;
    }
    for (const [from, to] of piecesOf(place.corners)) made.push({ from: this.onGround(from), to: this.onGround(to), place });
    return made;
  }

  private onGround([x, y]: number[]): THREE.Vector3 {
    return new THREE.Vector3(x, y, this.ground.at(x, y) + ABOVE_GROUND_M).sub(this.viewer.origin);
  }
}

/** The edges of a square that stands on a corner. */
function diamond(reach: number): number[][][] {
  const corners = [[reach, 0], [0, reach], [-reach, 0], [0, -reach]];
  return corners.map((corner, i) => [corner, corners[(i + 1) % 4]]);
}

/** From a place to a piece of a line, in the plane. */
function distanceTo([x, y]: number[], [ax, ay]: number[], [bx, by]: number[]): number {
  const dx = bx - ax, dy = by - ay, length = dx * dx + dy * dy;
  const t = length === 0 ? 0 : Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / length));
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}
