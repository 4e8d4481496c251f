// SPDX-License-Identifier: Apache-2.0
// Shows the page's state in the 3D view: colours, lit objects, boxes, slices, sensor path; and moves the camera.
import * as THREE from 'three';
import { capitalised, type Box, type MapModel, type MapObject } from '../data/model';
import type { Store } from '../state';
import { BoxLines } from './boxes';
import type { GroundHeights } from './ground';
import { COLOUR_MODES } from './materials';
import type { Viewer } from './viewer';

const BACKGROUND = { light: '#eef1f5', dark: '#14181f' };
const DIMMED = { light: '#d3d9e1', dark: '#2a313b' };
const ACCENT = { light: '#0b5fd0', dark: '#7ab4ff' };
const MOST_BOXES = 20_000;

export class Stage {
  private readonly objectBoxes: BoxLines;
  private readonly selection: BoxLines;
  private readonly selectionBehind: BoxLines;
  private readonly sensorPath: THREE.Group;
  /** What the points are drawn by: when it changes, colours alone do not do. */
  private drawn: unknown[] = [];

  constructor(readonly viewer: Viewer, private readonly model: MapModel, private readonly store: Store,
              private readonly ground: GroundHeights) {
    this.objectBoxes = new BoxLines(viewer.origin, 0.8);
    this.selection = new BoxLines(viewer.origin, 1);
    this.selectionBehind = new BoxLines(viewer.origin, 0.35, true);
    this.sensorPath = pathOf(model, viewer.origin);
    viewer.overlay.add(this.objectBoxes.lines, this.selectionBehind.lines, this.selection.lines, this.sensorPath);
    store.on(['theme'], () => this.showTheme());
    store.on(['lit', 'tints', 'hiddenClasses', 'colourMode', 'slice', 'scans'], () => this.showPoints());
    store.on(['lit', 'hiddenClasses', 'boxes', 'selected', 'theme'], () => this.showBoxes());
    store.on(['sensorPath'], () => this.showBoxes());
    this.showTheme();
    this.showPoints();
    this.showBoxes();
  }

  /** The whole map, from aside or from above. */
  home(fromAbove = false): void {
    const box = this.bounds(), center = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
    center.z = box.min.z + Math.min(size.z * 0.5, 3);
    const reach = 0.5 * Math.hypot(size.x, size.y) / Math.tan((this.viewer.camera.fov * Math.PI) / 360);
    const narrow = Math.max(1, 1.15 / this.viewer.camera.aspect);
    const direction = fromAbove ? new THREE.Vector3(0, -0.01, 1) : new THREE.Vector3(-0.45, -0.72, 0.55);
    this.look(center, direction, reach * (fromAbove ? 0.9 : 0.56) * narrow);
  }

  /** Moves near an object, keeping the direction of the view. */
  goTo(box: Box): void {
    const { camera, controls, origin } = this.viewer;
    const center = new THREE.Vector3(box.x, box.y, box.z).sub(origin);
    const direction = camera.position.clone().sub(controls.target).normalize();
    direction.z = Math.max(direction.z, 0.35);
    this.look(center, direction, Math.max(13, 2.8 * Math.hypot(box.length, box.width, box.height)));
  }

  /** Moves near a place of the map, on the ground where its height is not given. */
  goToPlace([x, y, z]: number[]): void {
    this.goTo({ x, y, z: z ?? this.ground.at(x, y), length: 4, width: 4, height: 2, yaw: 0 });
  }

  look(target: THREE.Vector3, direction: THREE.Vector3, distance: number): void {
    const { camera, controls } = this.viewer;
    controls.target.copy(target);
    camera.position.copy(target).addScaledVector(direction.clone().normalize(), distance);
    controls.update();
    this.viewer.moved();
  }

  select(object: MapObject | null): void {
    this.store.set('selected', object);
  }

  /** The box around the tiles in which nearly all points lie: single far points do not make the map small. */
  private bounds(): THREE.Box3 {
    const { tiles } = this.model.values, total = tiles.reduce((sum, tile) => sum + tile.pointsTo.at(-1)!, 0);
    const between = (axis: 0 | 1): [number, number] => {
      const sorted = [...tiles].sort((a, b) => a.origin[axis] - b.origin[axis]);
      let seen = 0, low = Infinity, high = -Infinity;
      for (const tile of sorted) {
        if (seen + tile.pointsTo.at(-1)! > 0.04 * total) low = Math.min(low, tile.origin[axis]);
        if (seen < 0.96 * total) high = Math.max(high, tile.origin[axis] + tile.size[axis]);
        seen += tile.pointsTo.at(-1)!;
      }
      return [low, high];
    };
    const x = between(0), y = between(1), z = Math.min(...tiles.map((tile) => tile.origin[2]));
    const top = Math.max(...tiles.map((tile) => tile.origin[2] + tile.size[2]));
    const box = new THREE.Box3(new THREE.Vector3(x[0], y[0], z), new THREE.Vector3(x[1], y[1], top));
    return tiles.length === 0 ? new THREE.Box3(new THREE.Vector3(), new THREE.Vector3(10, 10, 10))
                              : box.translate(this.viewer.origin.clone().negate());
  }

  private showTheme(): void {
    const theme = this.store.state.theme;
    this.viewer.setBackground(BACKGROUND[theme], DIMMED[theme]);
  }

  private showPoints(): void {
    const { lit, tints, hiddenClasses, colourMode, slice, scans } = this.store.state, { palette, uniforms } = this.viewer;
    const scheme = colourMode === 'certainty' || colourMode === 'distinct' ? colourMode : 'class';
    palette.show({ scheme, lit: lit && lit.objects, hiddenClasses, tints });
    const mode = COLOUR_MODES.indexOf(tints ? 'class' : colourMode), drawn = [mode, slice, scans, hiddenClasses];
    uniforms.mode.value = mode;
    const { lowestHeight, heightStep } = this.model.values;
    const byteOf = (height: number) => (height - lowestHeight) / heightStep;
    uniforms.slice.value.set(slice ? byteOf(slice[0]) : 0, slice && slice[1] < 29 ? byteOf(slice[1]) : 255);
    uniforms.scans.value.set(scans ? scans[0] : 0, scans ? scans[1] : 65535);
    uniforms.heightRange.value.set(byteOf(0), byteOf(12));
    if (drawn.some((value, i) => value !== this.drawn[i])) this.viewer.refresh();
    else this.viewer.recolour();
    this.drawn = drawn;
  }

  private showBoxes(): void {
    const { lit, boxes, selected, theme, sensorPath } = this.store.state, { palette } = this.viewer;
    const shown = boxes ? (lit ? lit.objects : this.model.objects).filter((object) => !palette.isHidden(object)) : [];
    this.objectBoxes.set(shown.filter((object) => object.class.label.toLowerCase() !== 'ground').slice(0, MOST_BOXES)
      .map((object) => ({ box: object.box, color: object.class.color || ACCENT[theme] })));
    const chosen = selected
      ? [{ box: selected.box, color: ACCENT[theme] },
         ...selected.parts.map((part) => ({ box: part.box, color: this.model.classOf(part.class).color || ACCENT[theme] }))]
      : [];
    this.selection.set(chosen);
    this.selectionBehind.set(chosen);
    this.sensorPath.visible = sensorPath;
    this.viewer.refreshOverlay();
  }
}

/** Where the scans were taken; clouds stand in the order of their times. */
function pathOf(model: MapModel, origin: THREE.Vector3): THREE.Group {
  const group = new THREE.Group();
  const places = model.values.clouds.filter((cloud) => cloud.position)
    .map((cloud) => new THREE.Vector3(...cloud.position!).sub(origin));
  const geometry = new THREE.BufferGeometry().setFromPoints(places);
  group.add(new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: '#e8590c' })));
  group.add(new THREE.Points(geometry, new THREE.PointsMaterial({ color: '#e8590c', size: 9, sizeAttenuation: false })));
  group.traverse((item) => { item.frustumCulled = false; });
  group.visible = false;
  return group;
}

export function titleOf(object: MapObject): string {
  return capitalised(object.class.label);
}
