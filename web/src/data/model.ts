// SPDX-License-Identifier: Apache-2.0
// A map as the page knows it: classes, objects by number, clouds, tiles, shipped questions.
import { blockJson, blockText, hasBlock } from './blocks';

export const CLX = 'https://w3id.org/cluxel/ontology#';
export const MAP = 'https://w3id.org/cluxel/map/';
export const OBJECT = `${MAP}object/`;
const REASONS_IN_BLOCK = 64;

export interface Box {
  x: number; y: number; z: number;
  length: number; width: number; height: number;
  yaw: number;
}
export interface Part { class: string; box: Box }
export interface ClassInfo {
  iri: string; label: string; comment: string; color: string; movable: boolean; ancestors: string[];
  /** The map has one object of it, over all of the map. */
  whole?: boolean;
}
export interface MapObject {
  number: number;
  id: string;
  iri: string;
  class: ClassInfo;
  confidence: number;
  rule: string;
  box: Box;
  bottom: number;
  top: number;
  points: number;
  parts: Part[];
}
export interface Cloud { id: string; points: number; source: string; time?: number; position?: number[] }
export interface TileInfo { origin: number[]; size: number[]; zQuantum: number; pointsTo: number[] }
export interface Parameter { name: string; unit: string; value: string; help: string }
export interface Column { name: string; unit: string; help: string }
export interface Question { file: string; title: string; text: string; parameters: Parameter[]; columns: Column[] }
export interface Property { iri: string; label: string; unit: string }
/** A parameter of a task; kinds are those of cluxel tasks. */
export interface TaskParameter {
  name: string; kind: 'number' | 'whole number' | 'class' | 'place' | 'text' | 'flag'; unit: string; help: string;
  default?: string; required?: boolean; repeated?: boolean; min?: number; max?: number;
}
export interface Task { name: string; title: string; reasons: boolean; file?: string; parameters: TaskParameter[]; columns: Column[] }
export interface RuleFile { name: string; text: string; root: boolean }
/** Scans taken without a long pause; times in seconds since 1970. */
export interface Visit { begin: number; end: number; scans: number }
export interface Extent { min: number[]; max: number[] }
/** Of something that is no object, the names are null. */
interface ChangedThing { object: string | null; number: number | null; class: string | null; part: boolean; box_m: Extent }
export interface SiteChange extends ChangedThing { change: 'vanished' | 'appeared' | 'moved'; now?: ChangedThing; distance?: number }
type Presence = 'present' | 'absent' | 'not observed';
export interface ObjectStates { object: string; number: number; before: Presence; after: Presence }
/** What the scans of a visit show against those of the visits shortly before it. */
export interface VisitChanges { since: string; changes: SiteChange[]; states: ObjectStates[] }
/** An earlier object that an object was made of, by which operation and when. */
export interface Ancestor { from: string; operation: string; time: string }
interface MapValues {
  name: string; served: boolean; state?: string; tileState?: string; finished: boolean; crs: string; origin: number[];
  points: number; pointsInMap: number; quadsLeftOut: number;
  quantum: number; lowestHeight: number; heightStep: number; intensity: number[];
  labels: string[]; clouds: Cloud[]; tiles: TileInfo[]; questions: Question[]; properties: Property[];
  tasks: Task[]; rules: RuleFile[]; sparqlRules: { name: string; text: string }[]; visits: Visit[];
}
interface ObjectValues {
  classes: ClassInfo[];
  id: string[]; class: string[]; confidence: number[]; rule: string[];
  box: number[][]; bottom: number[]; top: number[]; points: number[];
  parts: { class: string; box: number[] }[][];
}

export interface Step {
  test: string; passed: boolean; file: string; line: number; unit: string;
  measured?: number; threshold?: number;
}
export interface Change { test: string; measured: number; threshold: number; unit: string }
export interface Verdict {
  class: string; rule: string; accepted: boolean; reason: string; path?: Step[]; hint?: string;
  least_change?: { accepted: boolean; outcome: string; changes: Change[] };
  log_odds?: number; probability?: number; evidence?: EvidenceLine[]; rivals?: Rival[];
}
/** What one line of evidence adds to the log-odds of a candidate. */
export interface EvidenceLine { of: string; log_odds: number; unit: string; measured?: number; holds?: boolean; file: string; line: number }
/** A candidate that wanted some of the same points. */
export interface Rival { class: string; rule: string; log_odds: number; won: boolean }
export interface Reasons { primitive: string; label: string; note?: string; decisions?: Verdict[] }

export function localName(iri: string): string {
  return iri.slice(Math.max(iri.lastIndexOf('#'), iri.lastIndexOf('/')) + 1);
}

/** A class such that the service and the commands mean no other: "Tree" of Cluxel's own, else the IRI. */
export function classWord(iri: string): string {
  return iri.startsWith(CLX) ? iri.slice(CLX.length) : iri;
}

function boxOf(v: number[]): Box {
  return { x: v[0], y: v[1], z: v[2], length: v[3], width: v[4], height: v[5], yaw: v[6] };
}

const UNKNOWN_COLOR = '#808080';

export class MapModel {
  readonly objects: MapObject[];
  readonly classes = new Map<string, ClassInfo>();
  /** Classes that objects have, most frequent first. */
  readonly shownClasses: { info: ClassInfo; count: number }[];
  private readonly byIri = new Map<string, MapObject>();
  private lineage: Promise<Record<string, Ancestor[]>> | undefined;
  private visitChanges: Promise<VisitChanges[]> | undefined;
  private readonly reasonBlocks = new Map<number, Promise<Reasons[]>>();

  static async read(): Promise<MapModel> {
    return new MapModel(await blockJson<MapValues>('map'), await blockJson<ObjectValues>('objects'));
  }

  private constructor(readonly values: MapValues, columns: ObjectValues) {
    for (const info of columns.classes) this.classes.set(info.iri, info);
    this.objects = columns.id.map((id, number) => ({
      number, id, iri: OBJECT + id,
      class: this.classOf(columns.class[number]),
      confidence: columns.confidence[number], rule: columns.rule[number], box: boxOf(columns.box[number]),
      bottom: columns.bottom[number], top: columns.top[number], points: columns.points[number],
      parts: columns.parts[number].map((part) => ({ class: part.class, box: boxOf(part.box) })),
    }));
    const counts = new Map<ClassInfo, number>();
    for (const object of this.objects) {
      this.byIri.set(object.iri, object);
      counts.set(object.class, (counts.get(object.class) ?? 0) + 1);
    }
    this.shownClasses = [...counts].map(([info, count]) => ({ info, count }));
    this.shownClasses.sort((a, b) => b.count - a.count || (a.info.label < b.info.label ? -1 : 1));
  }

  classOf(iri: string): ClassInfo {
    const known = this.classes.get(iri);
    if (known) return known;
    const made = { iri, label: localName(iri), comment: '', color: UNKNOWN_COLOR, movable: false, ancestors: [] };
    this.classes.set(iri, made);
    return made;
  }

  /** The label for people; where several classes have it, with what tells them apart. */
  titleOf(info: ClassInfo): string {
    const title = capitalised(info.label), word = classWord(info.iri);
    const isShared = [...this.classes.values()].some((other) => other !== info && capitalised(other.label) === title);
    return isShared ? `${title} (${word})` : title;
  }

  objectOf(iri: string): MapObject | undefined {
    return this.byIri.get(iri);
  }

  /** By the first digits of its hash, as the address of the page holds it. */
  objectStartingWith(digits: string): MapObject | undefined {
    return digits.length < 4 ? undefined : this.objects.find((object) => object.id.startsWith(digits));
  }

  /** The objects of a class or of one below it. */
  objectsOfClass(iri: string): MapObject[] {
    return this.objects.filter((object) => object.class.iri === iri || object.class.ancestors.includes(iri));
  }

  /** By visit but the first. */
  changes(): Promise<VisitChanges[]> {
    this.visitChanges ??= blockJson<VisitChanges[]>('changes');
    return this.visitChanges;
  }

  /** As the history of the map told when the page was written. */
  async lineageOf(object: MapObject): Promise<Ancestor[]> {
    this.lineage ??= blockJson<Record<string, Ancestor[]>>('lineage');
    return (await this.lineage)[object.number] ?? [];
  }

  get hasReasons(): boolean {
    return hasBlock('reasons-0');
  }

  async reasonsOf(object: MapObject): Promise<Reasons | undefined> {
    if (!this.hasReasons) return undefined;
    const number = Math.floor(object.number / REASONS_IN_BLOCK);
    let block = this.reasonBlocks.get(number);
    if (!block) {
      block = blockText(`reasons-${number}`).then((text) =>
        text.split('\n').filter((line) => line !== '').map((line) => JSON.parse(line) as Reasons));
      this.reasonBlocks.set(number, block);
    }
    return (await block)[object.number % REASONS_IN_BLOCK];
  }
}

/** The middle of a thing that changed. */
export function middleOf(thing: ChangedThing): [number, number, number] {
  return [0, 1, 2].map((axis) => 0.5 * (thing.box_m.min[axis] + thing.box_m.max[axis])) as [number, number, number];
}

/** "Street sign 6b9130b2": the name of an object for people. */
export function nameOf(object: MapObject): string {
  return `${capitalised(object.class.label)} ${object.id.slice(0, 8)}`;
}

export function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
