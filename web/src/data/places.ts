// SPDX-License-Identifier: Apache-2.0
// Places of the map: ways, junctions, crossings, regions, rows and fronts, read from its facts when they are first wanted.
import type { Rows } from '../sparql/answers';
import type { Engine } from '../sparql/engine';
import { CLX, localName, type ClassInfo, type MapModel, type MapObject } from './model';

const PLACE = `${CLX}Place`;
const TYPE = 'http://www.w3.org/1999/02/22-rdf-syntax-ns#type';
const FACTS = `PREFIX clx: <${CLX}> PREFIX geo: <http://www.opengis.net/ont/geosparql#>
  SELECT ?place ?property ?value ?shape { ?place a clx:Place ; ?property ?value OPTIONAL { ?value geo:asWKT ?shape } } ORDER BY ?place ?property ?value`;
const RULES = `PREFIX clx: <${CLX}> PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#>
  SELECT DISTINCT ?place ?class ?rule { ?place a clx:Place . ?fact a clx:Derivation ; rdf:subject ?place ; rdf:predicate rdf:type ;
    rdf:object ?class ; clx:rule ?rule } ORDER BY ?place ?class ?rule`;
/** Where a place is stands in its shape. */
const BOUNDS = /^(min|max)[XYZ]$|^[xyz]$/;
/** Shares and slopes are read as percent. */
const PERCENT = new Set(['slope', 'lowerBeside', 'higherBeside']);

export interface Measure { label: string; value: number; unit: string }
export interface Place {
  iri: string;
  id: string;
  info: ClassInfo;
  kind: 'line' | 'mark' | 'outline';
  /** Corners: x and y [m, map]. */
  corners: number[][];
  measures: Measure[];
  /** IRIs of places that it meets or lies in, with the label of the relation. */
  related: { label: string; iri: string }[];
  members: MapObject[];
  /** The rules that gave it a class. */
  rules: { info: ClassInfo; file: string }[];
}

export class Places {
  private known: Promise<Map<string, Place>> | undefined;

  constructor(private readonly model: MapModel, private readonly engine: Engine) {}

  /** By IRI. */
  all(): Promise<Map<string, Place>> {
    this.known ??= this.read().catch((fault: unknown) => {
      this.known = undefined;  // a stopped engine may be asked again
      throw fault;
    });
    return this.known;
  }

  private async read(): Promise<Map<string, Place>> {
    const facts = (await this.engine.ask(FACTS)) as Rows, rules = (await this.engine.ask(RULES)) as Rows;
    const rulesOf = grouped(rules), places = new Map<string, Place>();
    for (const [iri, rows] of grouped(facts)) {
      const place = this.placeOf(iri, rows, rulesOf.get(iri) ?? []);
      if (place) places.set(iri, place);
    }
    return places;
  }

  private placeOf(iri: string, facts: string[][], rules: string[][]): Place | undefined {
    const shape = facts.map(([, , shape]) => shapeOf(shape)).find(Boolean);
    if (!shape) return undefined;
    const made = rules.map(([info, file]) => ({ info: this.model.classOf(info), file }));
    const place: Place = { iri, id: localName(iri), info: this.classOfPlace(facts, made), ...shape, measures: [], related: [],
                           members: [], rules: made };
    for (const [property, value] of facts) this.addFact(place, property, value);
    return place;
  }

  /** The most special class; of several the one that a rule gave. */
  private classOfPlace(facts: string[][], made: { info: ClassInfo }[]): ClassInfo {
    const classes = facts.filter(([property]) => property === TYPE).map(([, iri]) => this.model.classOf(iri))
      .filter((info) => info.iri === PLACE || info.ancestors.includes(PLACE));
    const rank = (info: ClassInfo) => 2 * info.ancestors.length + (made.some((rule) => rule.info === info) ? 1 : 0);
    return classes.reduce((best, info) => (rank(info) > rank(best) ? info : best), this.model.classOf(PLACE));
  }

  private addFact(place: Place, property: string, value: string): void {
    const name = localName(property), known = this.model.values.properties.find((candidate) => candidate.iri === property);
    const label = known?.label || name;
    if (!property.startsWith(CLX) || BOUNDS.test(name)) return;
    const object = this.model.objectOf(value);
    if (object) {
      if (name === 'hasMember') place.members.push(object);
    } else if (/^https?:/.test(value)) {
      place.related.push({ label, iri: value });
    } else if (Number.isFinite(Number(value))) {
      const share = PERCENT.has(name), unit = known?.unit && known.unit !== '1' ? known.unit : '';
      place.measures.push({ label, value: share ? 100 * Number(value) : Number(value), unit: share ? '%' : unit });
    }
  }
}

/** The values of rows behind the first, by the first. */
function grouped(answer: Rows): Map<string, string[][]> {
  const groups = new Map<string, string[][]>();
  for (const [first, ...others] of answer.rows) {
    const key = first!.value, texts = others.map((term) => term?.value ?? '');
    const group = groups.get(key);
    if (group) group.push(texts);
    else groups.set(key, [texts]);
  }
  return groups;
}

/** LINESTRING, POINT and POLYGON of well-known text; others are no shape of a place. */
export function shapeOf(text: string): Pick<Place, 'kind' | 'corners'> | undefined {
  const found = /^(?:<[^>]*>\s*)?(LINESTRING|POINT|POLYGON)(?:\s+Z)?\s*\(+([^)]*)\)/i.exec(text);
  if (!found) return undefined;
  const corners = found[2].split(',').map((corner) => corner.trim().split(/\s+/).slice(0, 2).map(Number));
  if (corners.some((corner) => corner.length < 2 || !corner.every(Number.isFinite))) return undefined;
  const kinds = { LINESTRING: 'line', POINT: 'mark', POLYGON: 'outline' } as const;
  return { kind: kinds[found[1].toUpperCase() as keyof typeof kinds], corners };
}
