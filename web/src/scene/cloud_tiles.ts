// SPDX-License-Identifier: Apache-2.0
// Turns the planes of bytes of a tile into vertex buffers.
import * as THREE from 'three';
import { blockBytes } from '../data/blocks';
import type { MapModel, TileInfo } from '../data/model';
import type { Service } from '../data/service';

/** Bytes of a vertex: x, y, z, cloud (2 each), object (4), intensity, height, label, coverage (1 each). */
const STRIDE = 16;
const COVERAGE_CELL_M = 0.5;
/** Edge of a tile seen from above [m]. */
const TILE_M = 16;

export interface Tile {
  info: TileInfo;
  number: number;
  points: THREE.Points<THREE.BufferGeometry, THREE.Material>;
  center: THREE.Vector3;
  /** First point of each level, and the number of points at the end. */
  levels: number[];
  buffer: ArrayBuffer;
  /** Size of its points [m]: sparse tiles have larger ones. */
  spread: number;
}

/** Planes: x, y, z (low and high bytes), object (3), cloud (2), intensity, height, label. */
function vertexBuffer(planes: Uint8Array, count: number): ArrayBuffer {
  const buffer = new ArrayBuffer(count * STRIDE);
  const shorts = new Uint16Array(buffer), words = new Uint32Array(buffer), bytes = new Uint8Array(buffer);
  for (let i = 0; i < count; ++i) {
    const byteAt = (plane: number) => planes[plane * count + i];
    shorts[8 * i] = byteAt(0) | (byteAt(1) << 8);
    shorts[8 * i + 1] = byteAt(2) | (byteAt(3) << 8);
    shorts[8 * i + 2] = byteAt(4) | (byteAt(5) << 8);
    shorts[8 * i + 3] = byteAt(9) | (byteAt(10) << 8);
    words[4 * i + 2] = byteAt(6) | (byteAt(7) << 8) | (byteAt(8) << 16);
    bytes[16 * i + 12] = byteAt(11);
    bytes[16 * i + 13] = byteAt(12);
    bytes[16 * i + 14] = byteAt(13);
  }
  return buffer;
}

/** Enters into each point how many scans have a point within its column of half a metre. */
function addCoverage(buffer: ArrayBuffer, count: number, quantum: number, clouds: number): void {
  const shorts = new Uint16Array(buffer), bytes = new Uint8Array(buffer), scans = new Map<number, Set<number>>();
  if (clouds < 2) return;
  const cellOf = (i: number) => Math.floor((shorts[8 * i] * quantum) / COVERAGE_CELL_M) * 65536 +
                                Math.floor((shorts[8 * i + 1] * quantum) / COVERAGE_CELL_M);
  for (let i = 0; i < count; ++i) {
    const cell = cellOf(i), known = scans.get(cell);
    if (known) known.add(shorts[8 * i + 3]);
    else scans.set(cell, new Set([shorts[8 * i + 3]]));
  }
  for (let i = 0; i < count; ++i) bytes[16 * i + 15] = Math.min(255, scans.get(cellOf(i))!.size);
}

function geometryOf(buffer: ArrayBuffer, info: TileInfo, quantum: number): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  const shorts = new THREE.InterleavedBuffer(new Uint16Array(buffer), STRIDE / 2);
  const words = new THREE.InterleavedBuffer(new Uint32Array(buffer), STRIDE / 4);
  const bytes = new THREE.InterleavedBuffer(new Uint8Array(buffer), STRIDE);
  geometry.setAttribute('position', new THREE.InterleavedBufferAttribute(shorts, 3, 0));
  geometry.setAttribute('cloud', new THREE.InterleavedBufferAttribute(shorts, 1, 3));
  geometry.setAttribute('object', new THREE.InterleavedBufferAttribute(words, 1, 2));
  geometry.setAttribute('measures', new THREE.InterleavedBufferAttribute(bytes, 4, 12));
  const size = new THREE.Vector3(info.size[0] / quantum, info.size[1] / quantum, info.size[2] / info.zQuantum);
  geometry.boundingBox = new THREE.Box3(new THREE.Vector3(), size);
  geometry.boundingSphere = geometry.boundingBox.getBoundingSphere(new THREE.Sphere());
  return geometry;
}

/** Reads tile `number` of the page. `origin` is the place in the map that the scene has as its zero. */
export async function readTile(model: MapModel, number: number, origin: THREE.Vector3, material: THREE.Material):
    Promise<Tile> {
  return tileOf(model, number, model.values.tiles[number], await blockBytes(`tile-${number}`), origin, material);
}

/** Tile `number` with all of its points, from the service. */
export async function fetchTile(model: MapModel, service: Service, number: number, origin: THREE.Vector3, material: THREE.Material):
    Promise<Tile> {
  const { tiles, tileState, intensity } = model.values, corner = tiles[number].origin;
  const place = [corner[0], corner[1]].map((value) => Math.round(value / TILE_M)).join('/');
  const bytes = await service.bytes(`tiles/${place}?state=${tileState}&intensity=${intensity.join(',')}`);
  const end = bytes.indexOf(10);
  const info = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end))) as TileInfo;
  return tileOf(model, number, info, bytes.subarray(end + 1), origin, material);
}

function tileOf(model: MapModel, number: number, info: TileInfo, planes: Uint8Array, origin: THREE.Vector3,
                material: THREE.Material): Tile {
  const quantum = model.values.quantum, count = info.pointsTo[info.pointsTo.length - 1];
  if (planes.length !== 14 * count) throw new Error(`Tile ${number} of this page is damaged. Write it anew.`);
  const buffer = vertexBuffer(planes, count);
  addCoverage(buffer, count, quantum, model.values.clouds.length);
  const points = new THREE.Points(geometryOf(buffer, info, quantum), material);
  points.position.set(info.origin[0], info.origin[1], info.origin[2]).sub(origin);
  points.scale.set(quantum, quantum, info.zQuantum);
  points.updateMatrixWorld();
  points.matrixAutoUpdate = false;
  const center = points.geometry.boundingSphere!.center.clone().applyMatrix4(points.matrixWorld);
  const spread = Math.min(0.11, Math.max(0.03, 0.55 * Math.sqrt((info.size[0] * info.size[1]) / count)));
  return { info, number, points, center, levels: [0, ...info.pointsTo], buffer, spread };
}

/** The point of an object (its number + 1; 0: of none) that is nearest to a place in the scene, within `reach` [m]. */
export function pointNear(tile: Tile, object: number, place: THREE.Vector3, reach: number): THREE.Vector3 | undefined {
  const toTile = tile.points.matrixWorld.clone().invert(), scale = new THREE.Vector3().setFromMatrixScale(tile.points.matrixWorld);
  const wanted = place.clone().applyMatrix4(toTile), shorts = new Uint16Array(tile.buffer), words = new Uint32Array(tile.buffer);
  const room = new THREE.Vector3(reach, reach, reach).divide(scale);
  if (!tile.points.geometry.boundingBox!.clone().expandByVector(room).containsPoint(wanted)) return undefined;
  let best = reach * reach, at = -1;
  for (let i = 0; i < words.length / 4; ++i) {
    if (words[4 * i + 2] !== object) continue;
    const dx = (shorts[8 * i] - wanted.x) * scale.x, dy = (shorts[8 * i + 1] - wanted.y) * scale.y, dz = (shorts[8 * i + 2] - wanted.z) * scale.z;
    const distance = dx * dx + dy * dy + dz * dz;
    if (distance < best) [best, at] = [distance, i];
  }
  if (at < 0) return undefined;
  return new THREE.Vector3(shorts[8 * at], shorts[8 * at + 1], shorts[8 * at + 2]).applyMatrix4(tile.points.matrixWorld);
}
