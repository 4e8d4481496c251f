// SPDX-License-Identifier: Apache-2.0
// What an object was made of and, when the map has changed under the page, what became of it.
import { CLX, type MapModel, type MapObject } from '../data/model';
import type { Service } from '../data/service';
import { el, faultNote } from '../dom';
import { shortened } from './editor';

/** What the history says of an object now; a file holds what it said when it was written. */
const LINEAGE = (iri: string) => `PREFIX prov: <http://www.w3.org/ns/prov#> PREFIX clx: <${CLX}>
  SELECT ?isThere ?kind ?object ?operation ?time { BIND(EXISTS { <${iri}> a ?class } AS ?isThere)
    OPTIONAL { GRAPH <https://w3id.org/cluxel/graph/history> {
      { <${iri}> prov:wasDerivedFrom ?object BIND("from" AS ?kind) OPTIONAL { <${iri}> prov:wasGeneratedBy ?run } }
      UNION { ?object prov:wasDerivedFrom <${iri}> BIND("next" AS ?kind) OPTIONAL { ?object prov:wasGeneratedBy ?run } }
      UNION { <${iri}> prov:wasInvalidatedBy ?run BIND("end" AS ?kind) }
      OPTIONAL { ?run clx:operation ?operation ; prov:endedAtTime ?time } } } } ORDER BY ?time ?object`;
interface Link { kind: string; object: string; operation: string; time: string }
interface Told { isThere: boolean; links: Link[] }
interface LineageJson { results: { bindings: Record<string, { value: string } | undefined>[] } }

async function askedLineage(service: Service, object: MapObject): Promise<Told> {
  const told = await service.json<LineageJson>(`sparql?format=json&query=${encodeURIComponent(LINEAGE(object.iri))}`);
  const rows = told.results.bindings, text = (row: (typeof rows)[0], name: string) => row[name]?.value ?? '';
  const links = rows.map((row) => ({ kind: text(row, 'kind'), object: text(row, 'object'), operation: text(row, 'operation'), time: text(row, 'time') }));
  return { isThere: rows.some((row) => text(row, 'isThere') === 'true'), links };
}

async function heldLineage(model: MapModel, object: MapObject): Promise<Told> {
  const links = (await model.lineageOf(object)).map((row) => ({ ...row, kind: 'from', object: row.from }));
  return { isThere: true, links };
}

const note = (text: string) => el('p', { class: 'note' }, text);
const when = (link: Link) => `${link.operation} ${link.time.slice(0, 16)}`;

function linksShown(links: Link[], word: string): HTMLElement {
  return el('ul', { class: 'plain-list' }, ...links.map((link) => el('li', { title: link.object },
      `${word} ${shortened(link.object).slice(0, 24)}`, el('small', {}, when(link)))));
}

function shown({ isThere, links }: Told, service: Service | undefined): HTMLElement[] {
  const from = links.filter(({ kind }) => kind === 'from'), next = links.filter(({ kind }) => kind === 'next');
  const end = links.filter(({ kind }) => kind === 'end').at(-1), made = from.length > 0 ? [linksShown(from, 'from')] : [];
  if (!isThere)
    return [note(`This object is no more in the map, which has changed since this page was made.${end ? ` It ended by ${when(end)}.` : ''}`),
            ...(next.length > 0 ? [linksShown(next, 'went on as')] : []), ...made];
  const told = made.length > 0 ? made : [note('It was made by the build, and no change has touched it.')];
  return service?.hasChanged ? [...told, note(service.note)] : told;
}

export function lineageOf(object: MapObject, model: MapModel, service: Service | undefined): HTMLElement {
  const host = el('div', { class: 'lineage-list' });
  const fill = async () => {
    if (host.childElementCount > 0) return;
    try {
      host.replaceChildren(...shown(service ? await askedLineage(service, object) : await heldLineage(model, object), service));
    } catch (fault) {
      host.replaceChildren(faultNote(fault));
    }
  };
  return el('details', { class: 'lineage', ontoggle: (event: Event) => { if ((event.target as HTMLDetailsElement).open) void fill(); } },
            el('summary', {}, 'Lineage'), host);
}
