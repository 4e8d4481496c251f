// SPDX-License-Identifier: Apache-2.0
// The 3D view: draws tiles over several frames into a picture with depth, shades it, and puts lines on it.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { MapModel } from '../data/model';
import type { Tile } from './cloud_tiles';
import { LevelOfDetail } from './level_of_detail';
import { pictureMaterial, pointMaterial, pointUniforms } from './materials';
import { Palette } from './palette';

const NEAR_M = 0.3, FAR_M = 3000, FIELD_OF_VIEW_DEG = 50;
/** While points are added, the picture is shown this often: the time between goes to points. */
const SHOWN_EVERY_MS = 120;

export class Viewer {
  readonly renderer: THREE.WebGLRenderer;
  readonly camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, NEAR_M, FAR_M);
  readonly controls: OrbitControls;
  readonly uniforms = pointUniforms();
  readonly material = pointMaterial(this.uniforms);
  readonly tiles: Tile[] = [];
  readonly cloud = new THREE.Scene();
  readonly overlay = new THREE.Scene();
  readonly detail = new LevelOfDetail();
  readonly palette: Palette;
  /** The place in the map that the scene has as its zero: floats are exact near it. */
  readonly origin: THREE.Vector3;
  /** Called for every frame that shows something new, after it was drawn. */
  onFrame: (() => void)[] = [];
  /** Called when the camera has moved. */
  onMove: (() => void)[] = [];
  /** Since the page was opened [ms]; 0 before. */
  firstPicture = 0;
  /** Numbers of objects by pixel, with depth. */
  readonly picture: THREE.WebGLRenderTarget;
  private readonly shading = pictureMaterial(this.uniforms);
  private readonly shadingScene = new THREE.Scene();
  private readonly shadingCamera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
  /** While a button is down no points are added: a click finds the graphics free. */
  private isHeld = false;
  private isStale = true;
  private isShadingStale = true;
  private lastFrame = 0;
  private lastPoints = 0;
  /** False after a picture in haste: one with full shading follows. */
  private isShownFine = false;
  private lastShown = 0;
  private fence: WebGLSync | null = null;

  constructor(readonly host: HTMLElement, model: MapModel) {
    const canvas = document.createElement('canvas');
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false, powerPreference: 'high-performance' });
    this.renderer.autoClear = false;
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    THREE.ColorManagement.enabled = false;
    host.append(canvas);
    canvas.tabIndex = 0;
    this.origin = originOf(model);
    this.palette = new Palette(model);
    this.uniforms.palette.value = this.palette.texture;
    this.uniforms.paletteWidth.value = this.palette.width;
    this.uniforms.clouds.value = model.values.clouds.length;
    this.uniforms.relief.value = model.values.intensity[1] > model.values.intensity[0] ? 1 : 0;
    this.picture = new THREE.WebGLRenderTarget(1, 1, {
      depthTexture: new THREE.DepthTexture(1, 1, THREE.UnsignedIntType),
      minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter,
    });
    const plane = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.shading);
    plane.frustumCulled = false;
    this.shadingScene.add(plane);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = 0.497 * Math.PI;
    this.controls.maxDistance = 1500;
    this.controls.screenSpacePanning = false;
    this.controls.addEventListener('change', () => this.moved());
    canvas.addEventListener('pointerdown', () => { this.isHeld = true; });
    for (const end of ['pointerup', 'pointercancel']) window.addEventListener(end, () => { this.isHeld = false; });
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
    this.renderer.setAnimationLoop((time) => this.frame(time));
  }

  addTile(tile: Tile): void {
    this.tiles.push(tile);
    this.place(tile);
    if (!this.isStale) this.detail.add(tile, this.camera);
  }

  /** Shows a tile in place of another one with more or fewer of the same points. */
  replaceTile(old: Tile, tile: Tile): void {
    this.tiles[this.tiles.indexOf(old)] = tile;
    this.cloud.remove(old.points);
    this.place(tile);
    this.refresh();
  }

  private place(tile: Tile): void {
    tile.points.onBeforeRender = () => {
      this.uniforms.spread.value = tile.spread;
      this.material.uniformsNeedUpdate = true;
    };
    this.cloud.add(tile.points);
  }

  /** Draws the points anew: the camera has changed, or which points are shown. */
  refresh(): void {
    this.isStale = true;
  }

  /** Shows the same points in other colours. */
  recolour(): void {
    this.isShadingStale = true;
  }

  /** Draws the lines anew over the same points. */
  refreshOverlay(): void {
    this.isShadingStale = true;
  }

  setBackground(background: string, dimmed: string): void {
    (this.shading.uniforms.background.value as THREE.Color).set(background);
    this.uniforms.dimmed.value.set(dimmed);
    this.recolour();
  }

  moved(): void {
    this.refresh();
    for (const call of this.onMove) call();
  }

  /** True when every visible point is drawn. */
  get isComplete(): boolean {
    return !this.isStale && !this.isShadingStale && this.isShownFine && this.detail.isDone && this.fence === null;
  }

  private resize(): void {
    const width = Math.max(1, this.host.clientWidth), height = Math.max(1, this.host.clientHeight);
    const ratio = Math.min(window.devicePixelRatio || 1, 1.5);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height);
    this.picture.setSize(Math.floor(width * ratio), Math.floor(height * ratio));
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.uniforms.pixelRatio.value = ratio;
    this.uniforms.pixelsPerMetre.value = height / (2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360));
    this.moved();
  }

  /** Changed colours and lines are shown before further points: who waits for them sees them first. */
  private frame(time: number): void {
    if (!this.isFrameFinished(time)) return;
    const isNew = this.isStale, drawsPoints = isNew || (!this.detail.isDone && !this.isShadingStale);
    if (!drawsPoints && !this.isShadingStale && this.isShownFine) return;
    if (this.isHeld && !isNew && !this.isShadingStale) return;
    if (isNew) this.beginPicture();
    this.lastPoints = drawsPoints ? this.drawPoints() : 0;
    this.lastFrame = time;
    if (isNew || !drawsPoints || this.detail.isDone || time - this.lastShown > SHOWN_EVERY_MS) this.show(time, isNew);
    this.setFence();
  }

  private beginPicture(): void {
    this.isStale = false;
    this.camera.updateMatrixWorld();
    this.detail.restart(this.tiles, this.camera);
    this.renderer.setRenderTarget(this.picture);
    this.renderer.clear();
  }

  /** Adds points to the picture; returns how many. */
  private drawPoints(): number {
    const points = this.detail.prepareFrame(this.tiles);
    this.renderer.setRenderTarget(this.picture);
    this.renderer.render(this.cloud, this.camera);
    return points;
  }

  private show(time: number, isNew: boolean): void {
    this.isShownFine = !isNew && this.detail.isDone;
    this.isShadingStale = false;
    this.lastShown = time;
    this.present(this.isShownFine);
    if (this.lastPoints > 0) this.firstPicture ||= performance.now();
    for (const call of this.onFrame) call();
  }

  /**
   * False while the graphics still draw the frame before: frames in a queue would delay what comes next. Its time sets the
   * number of points of later frames.
   */
  private isFrameFinished(time: number): boolean {
    if (!this.fence) return true;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (gl.clientWaitSync(this.fence, 0, 0) === gl.TIMEOUT_EXPIRED) return false;
    gl.deleteSync(this.fence);
    this.fence = null;
    if (this.lastPoints > 0) this.detail.learn(time - this.lastFrame, this.lastPoints);
    return true;
  }

  private setFence(): void {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
  }

  /** The picture with shading on the screen, and the lines on it. */
  private present(isFine: boolean): void {
    const uniforms = this.shading.uniforms;
    uniforms.isFine.value = isFine;
    uniforms.marks.value = this.picture.texture;
    uniforms.depths.value = this.picture.depthTexture;
    (uniforms.pixel.value as THREE.Vector2).set(1 / this.picture.width, 1 / this.picture.height);
    (uniforms.planes.value as THREE.Vector2).set(NEAR_M, FAR_M);
    this.renderer.setRenderTarget(null);
    this.renderer.clear();
    this.renderer.render(this.shadingScene, this.shadingCamera);
    this.renderer.render(this.overlay, this.camera);
  }
}

/** A round place in the middle of the map. */
function originOf(model: MapModel): THREE.Vector3 {
  const box = new THREE.Box3();
  for (const tile of model.values.tiles) {
    const low = new THREE.Vector3(...tile.origin);
    box.expandByPoint(low).expandByPoint(low.clone().add(new THREE.Vector3(...tile.size)));
  }
  return box.isEmpty() ? new THREE.Vector3() : box.getCenter(new THREE.Vector3()).round();
}
