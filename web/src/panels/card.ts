// SPDX-License-Identifier: Apache-2.0
// The card of the selected object: attributes with units, parts, scans that saw it, and reasons.
import { capitalised, CLX, type MapModel, type MapObject } from '../data/model';
import type { Service } from '../data/service';
import { counted, el, faultNote, iconButton, rounded, swatch } from '../dom';
import type { Answer, Rows } from '../sparql/answers';
import type { Portrait } from '../scene/portrait';
import type { Engine } from '../sparql/engine';
import type { Store } from '../state';
import { shortened } from './editor';
import { lineageOf } from './lineage';
import { reasonsView } from './reasons';
import { statementForm } from './statement';
import { WhyNotQuestion } from './why_not';

export class ObjectCard {
  readonly element = el('aside', { class: 'card', hidden: true, 'aria-label': 'Selected object', tabindex: -1 });

  private picture = el('canvas');

  constructor(private readonly model: MapModel, private readonly engine: Engine,
              private readonly service: Service | undefined, private readonly store: Store,
              private readonly portrait: Portrait, private readonly goTo: (object: MapObject) => void) {
    store.on(['selected'], (state) => this.show(state.selected));
  }

  /** Draws the picture anew, after more points have come. */
  redraw(): void {
    const object = this.store.state.selected;
    if (object) this.portrait.drawInto(this.picture, object);
  }

  private show(object: MapObject | null): void {
    this.element.hidden = object === null;
    if (!object) return;
    const facts = el('div', { class: 'facts' }), reasons = el('div', { class: 'reasons' }), position = el('dd', { 'data-measure': 'position' }, '…');
    const gone = el('p', { class: 'note', 'data-gone': '', hidden: true });
    const picture = el('canvas', { class: 'portrait', role: 'img', 'aria-label': `Points of ${object.class.label}` });
    this.picture = picture;
    this.drawSoon(picture, object);
    this.element.replaceChildren(this.head(object), gone, picture, this.measures(object, position), this.parts(object), reasons,
                                 el('details', { ontoggle: (event: Event) => {
                                   if ((event.target as HTMLDetailsElement).open) void this.fillFacts(object, facts);
                                 } }, el('summary', {}, 'All facts and observations'), facts),
                                 lineageOf(object, this.model, this.service), statementForm(object, this.model, this.service));
    this.element.scrollTop = 0;
    void this.fillReasons(object, reasons);
    void this.fillPosition(object, position);
    void this.fillGone(object, gone);
  }

  /** After the view has shown the selection: reading a picture back waits for the graphics. */
  private drawSoon(picture: HTMLCanvasElement, object: MapObject): void {
    const draw = () => { if (this.picture === picture) this.portrait.drawInto(picture, object); };
    requestAnimationFrame(() => requestAnimationFrame(draw));
  }

  private head(object: MapObject): HTMLElement {
    const color = object.class.color || '#808080';
    return el('header', {},
              swatch(color, 'large'),
              el('div', { class: 'titles' }, el('h2', {}, capitalised(object.class.label)),
                 el('code', { title: object.iri }, object.id.slice(0, 12))),
              iconButton('aim', 'Go to this object (F)', () => this.goTo(object)),
              iconButton('close', 'Close the card (Escape)', () => this.store.set('selected', null)));
  }

  private measures(object: MapObject, position: HTMLElement): HTMLElement {
    const { box } = object;
    const item = (name: string, value: string) => el('div', {}, el('dt', {}, name), el('dd', {}, value));
    return el('dl', { class: 'measures' },
              item('Confidence', `${rounded(100 * object.confidence, 1)} %`),
              item('Height', `${rounded(box.height, 2)} m`),
              item('Length × width', `${rounded(box.length, 2)} × ${rounded(box.width, 2)} m`),
              item('Top above ground', `${rounded(object.top, 2)} m`),
              item('Bottom above ground', `${rounded(object.bottom, 2)} m`),
              el('div', {}, el('dt', {}, 'Position'), position),
              item('Mobility', object.class.movable ? 'movable' : 'static'),
              item('Rule', object.rule),
              item('Points after thinning', counted(object.points)));
  }

  /** The mean of the points, as questions tell it; the middle of the box is another place. */
  private async fillPosition(object: MapObject, host: HTMLElement): Promise<void> {
    try {
      const answer = await this.engine.ask(`PREFIX clx: <${CLX}> SELECT ?x ?y { <${object.iri}> clx:x ?x ; clx:y ?y } ORDER BY ?x ?y LIMIT 1`);
      const place = (answer as Rows).rows[0]?.map((term) => rounded(Number(term!.value), 2));
      host.textContent = place ? `${place.join(', ')} m` : 'not in the facts';
    } catch (fault) {
      host.replaceChildren(faultNote(fault));
    }
  }

  /** Later scans may show that it is there no more; a fault of the engine is told at the position. */
  private async fillGone(object: MapObject, host: HTMLElement): Promise<void> {
    const answer = await this.engine.ask(`PREFIX clx: <${CLX}> SELECT ?time { <${object.iri}> clx:seenThrough ?time } LIMIT 1`).catch(() => null);
    const time = (answer as Rows | null)?.rows[0]?.[0]?.value;
    host.hidden = time === undefined;
    host.textContent = time === undefined ? '' : `Gone: a scan at ${time} saw through its place.`;
  }

  private parts(object: MapObject): HTMLElement | string {
    if (object.parts.length === 0) return '';
    return el('section', {}, el('h3', {}, 'Parts'), el('ul', { class: 'parts' }, ...object.parts.map((part) => {
      const info = this.model.classOf(part.class);
      return el('li', {}, swatch(info.color || '#808080'), capitalised(info.label),
                el('small', {}, `${rounded(part.box.height, 2)} m high, ${rounded(part.box.width, 2)} m wide`));
    })));
  }

  private async fillReasons(object: MapObject, host: HTMLElement): Promise<void> {
    let reasons;
    try {
      reasons = await this.model.reasonsOf(object);
    } catch (fault) {
      host.replaceChildren(faultNote(fault));
      return;
    }
    if (this.store.state.selected !== object) return;
    host.replaceWith(reasons ? reasonsView(reasons, this.model, new WhyNotQuestion(this.model, this.service, object).element, this.store)
                             : el('p', { class: 'note' }, 'This page was written without reasons: cluxel explain gives them.'));
  }

  private async fillFacts(object: MapObject, host: HTMLElement): Promise<void> {
    if (host.childElementCount > 0) return;
    host.append(el('p', { class: 'note' }, 'Reading…'));
    try {
      const facts = await this.engine.ask(`SELECT DISTINCT ?property ?value { <${object.iri}> ?property ?value } ORDER BY ?property ?value`);
      const seen = await this.engine.ask(`PREFIX clx: <${CLX}> PREFIX sosa: <http://www.w3.org/ns/sosa/>
        SELECT DISTINCT ?cloud ?points { ?o sosa:hasFeatureOfInterest <${object.iri}> ; clx:inCloud ?cloud ; clx:pointCount ?points } ORDER BY DESC(?points)`);
      host.replaceChildren(this.observations(seen), this.factTable(facts));
    } catch (fault) {
      host.replaceChildren(faultNote(fault));
    }
  }

  private observations(answer: Answer): HTMLElement {
    const rows = (answer as Rows).rows;
    return el('section', {}, el('h3', {}, `Seen in ${rows.length} ${rows.length === 1 ? 'scan' : 'scans'}`),
              el('ul', { class: 'plain-list' }, ...rows.map((row) => {
                const cloud = this.model.values.clouds.find((candidate) => row[0]!.value.endsWith(candidate.id));
                return el('li', {}, cloud?.source || row[0]!.value.slice(-12), el('small', {}, `${counted(Number(row[1]!.value))} points`));
              })));
  }

  private factTable(answer: Answer): HTMLElement {
    const rows = (answer as Rows).rows.map((row) => {
      const known = this.model.values.properties.find((property) => property.iri === row[0]!.value);
      const unit = known?.unit && known.unit !== '1' ? ` ${known.unit}` : '', value = row[1]!;
      return el('tr', {}, el('th', { scope: 'row', title: row[0]!.value }, known?.label || shortened(row[0]!.value)),
                el('td', { title: value.value }, (value.kind === 'iri' ? shortened(value.value) : value.value) + unit));
    });
    return el('section', {}, el('h3', {}, 'Facts'), el('table', { class: 'fact-table' }, el('tbody', {}, ...rows)));
  }
}
