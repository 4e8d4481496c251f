// SPDX-License-Identifier: Apache-2.0
// Puts the page together: reads the map, shows the view, then the points tile by tile.
import { Address } from './address';
import { MapModel, type MapObject } from './data/model';
import { Places } from './data/places';
import { Service } from './data/service';
import { counted, el } from './dom';
import { AskPanel } from './panels/ask';
import { ObjectCard } from './panels/card';
import { changedBanner } from './panels/changed';
import { Help } from './panels/help';
import { Legend } from './panels/legend';
import { PlaceCard } from './panels/place_card';
import { PlacePanel } from './panels/places';
import { RulePanel } from './panels/rules';
import { Tabs } from './panels/tabs';
import { TaskPanel } from './panels/tasks';
import { Toolbar } from './panels/toolbar';
import { VisitPanel } from './panels/visits';
import { readTile } from './scene/cloud_tiles';
import { FullTiles } from './scene/full_tiles';
import { GroundHeights } from './scene/ground';
import { MarkPaths } from './scene/mark_paths';
import { Measure } from './scene/measure';
import { Picking } from './scene/picking';
import { PlaceLines } from './scene/place_lines';
import { Pins } from './scene/pins';
import { Portrait } from './scene/portrait';
import { Stage } from './scene/stage';
import { Viewer } from './scene/viewer';
import { Engine } from './sparql/engine';
import { Store } from './state';

/** A press that moves farther than this is a drag, not a click [CSS pixels]. */
const CLICK_REACH = 5;

function initialStore(): Store {
  const isDark = matchMedia('(prefers-color-scheme: dark)').matches;
  return new Store({
    selected: null, place: null, lit: null, marks: [], tints: null, ruleLine: null, colourMode: 'class', hiddenClasses: new Set(), boxes: false, places: false, sensorPath: false,
    measuring: false, slice: null, scans: null, theme: isDark ? 'dark' : 'light',
  });
}

function titleBar(model: MapModel): HTMLElement {
  const { name, points, pointsInMap, quadsLeftOut, clouds, finished } = model.values;
  const shown = points < pointsInMap ? `${counted(points)} of ${counted(pointsInMap)}` : counted(points);
  return el('header', { class: 'title' },
            el('h1', {}, name), el('p', {}, `${counted(model.objects.length)} objects · ${shown} points · ${counted(clouds.length)} scans`),
            points < pointsInMap && el('p', { class: 'note thinned' }, 'Thinned to an even sample; questions see the whole map.'),
            quadsLeftOut > 0 && el('p', { class: 'note' }, `Questions see all but ${counted(quadsLeftOut)} facts about primitives; cluxel query sees all.`),
            !finished && el('p', { class: 'note' }, 'The build of this map is not finished.'));
}

/** Clicks in the view select objects or places, or measure. */
function listenToClicks(viewer: Viewer, picking: Picking, places: PlaceLines, store: Store, measure: Measure): void {
  const canvas = viewer.renderer.domElement;
  let down = { x: 0, y: 0 };
  canvas.addEventListener('pointerdown', (event) => { down = { x: event.offsetX, y: event.offsetY }; });
  canvas.addEventListener('pointerup', (event) => {
    if (event.button !== 0 || Math.hypot(event.offsetX - down.x, event.offsetY - down.y) > CLICK_REACH) return;
    const pick = picking.at(event.offsetX, event.offsetY);
    if (store.state.measuring) return pick && measure.add(pick.place);
    const place = places.at(event.offsetX, event.offsetY, pick?.place) ?? null;
    store.set('place', place);
    store.set('selected', place ? null : pick?.object ?? null);
  });
}

async function loadTiles(viewer: Viewer, model: MapModel, status: HTMLElement): Promise<void> {
  const { tiles } = model.values, target = viewer.controls.target.clone().add(viewer.origin);
  const order = tiles.map((_, number) => number);
  const distance = (number: number) => Math.hypot(tiles[number].origin[0] + 8 - target.x, tiles[number].origin[1] + 8 - target.y);
  order.sort((a, b) => distance(a) - distance(b));
  for (let i = 0; i < order.length; ++i) {
    viewer.addTile(await readTile(model, order[i], viewer.origin, viewer.material));
    status.textContent = `Reading points: ${i + 1} of ${order.length} tiles`;
    status.hidden = i + 1 === order.length;
  }
}

/** A served page gets all points near the camera. */
function completeTiles(viewer: Viewer, model: MapModel, service: Service): void {
  const { points, pointsInMap } = model.values, note = document.querySelector('.thinned');
  if (points === pointsInMap || !note) return;
  const full = new FullTiles(viewer, model, service);
  note.textContent = 'An even sample; near the camera all points are shown. Questions see the whole map.';
  full.onChange = (more, fault) => {
    note.textContent = fault ? `An even sample; not all points near the camera could be read: ${fault}`
                             : `An even sample, and ${counted(more)} more points near the camera. Questions see the whole map.`;
  };
  full.soon();
}

async function open(app: HTMLElement): Promise<void> {
  const model = await MapModel.read(), store = initialStore(), engine = new Engine();
  document.title = `${model.values.name} · Cluxel`;
  let tilesRead = () => {};
  const host = el('main', { class: 'view', 'aria-label': 'Map in 3D' });
  const reading = el('p', { class: 'reading', role: 'status' });
  const side = el('div', { class: 'side' }, titleBar(model));
  host.append(reading);
  app.replaceChildren(side, host);
  const showTheme = () => { document.documentElement.dataset.theme = store.state.theme; };
  store.on(['theme'], showTheme);
  showTheme();
  const viewer = new Viewer(host, model), ground = new GroundHeights(viewer, model), stage = new Stage(viewer, model, store, ground);
  viewer.renderer.domElement.setAttribute('aria-label', 'Points of the map in 3D. Arrow keys move the view.');
  viewer.controls.listenToKeyEvents(viewer.renderer.domElement);
  const service = Service.of(model), address = new Address(viewer, store, model), goTo = (object: MapObject) => stage.goTo(object.box);
  const places = new Places(model, engine), ask = new AskPanel(model, engine, store, address, places, stage), card = new ObjectCard(model, engine, service, store, new Portrait(viewer), goTo);
  const tasks = new TaskPanel(model, service, store, stage, ground), visits = new VisitPanel(model, store, stage);
  const rules = new RulePanel(model, service, store, stage);
  const tabs = new Tabs([{ id: 'questions', label: 'Questions', element: ask.element }, { id: 'tasks', label: 'Tasks', element: tasks.element },
                         { id: 'visits', label: 'Visits', element: visits.element }, { id: 'rules', label: 'Rules', element: rules.element }]);
  const help = new Help(model), toolbar = new Toolbar(stage, store, () => help.show(toolbar.commands), () => { tabs.show('questions'); ask.focus(); });
  store.on(['ruleLine'], () => tabs.show('rules'));
  store.on(['lit'], (state) => { if (state.lit) store.set('tints', null); });
  side.append(changedBanner(service), tabs.element, ask.element, tasks.element, visits.element, rules.element);
  const lines = new PlaceLines(viewer, ground), allRead = new Promise<void>((done) => { tilesRead = done; });
  const layer = new PlacePanel(places, lines, store, stage, allRead);
  host.append(new Legend(model, store, viewer.palette, layer.element).element, toolbar.element);
  app.append(card.element, new PlaceCard(model, places, store, stage).element, help.element);
  store.on(['selected'], (state) => { if (state.selected) store.set('place', null); });
  store.on(['place'], (state) => { if (state.place) store.set('selected', null); });
  new Pins(viewer, store);
  new MarkPaths(viewer, store, ground);
  listenToClicks(viewer, new Picking(viewer, model, store), lines, store, new Measure(viewer, store));
  const restored = address.restore();
  if (!restored.hasCamera) stage.home();
  app.removeAttribute('aria-busy');
  Object.assign(window, { cluxelPage: { model, store, viewer, stage, engine, lines } });  // for tests and the curious
  await loadTiles(viewer, model, reading);
  tilesRead();
  if (service) completeTiles(viewer, model, service);
  card.redraw();
  ask.restore(restored.question);
  void engine.start();
  if (restored.place) store.set('place', (await places.all()).get(restored.place) ?? null);
}

const app = document.getElementById('app')!;
open(app).catch((fault: unknown) => {
  const message = fault instanceof Error ? fault.message : String(fault);
  app.replaceChildren(el('p', { class: 'opening', role: 'alert' }, `The map cannot be shown: ${message}`));
  throw fault;
});
