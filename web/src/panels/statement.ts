// SPDX-License-Identifier: Apache-2.0
// A statement of a person about an object: text for cluxel update to copy, or saved by the service.
import { type ClassInfo, CLX, type MapModel, type MapObject } from '../data/model';
import type { Service } from '../data/service';
import { el } from '../dom';

const LABEL = 'http://www.w3.org/2000/01/rdf-schema#label';

export function statementForm(object: MapObject, model: MapModel, service: Service | undefined): HTMLElement {
  const kind = el('select', { id: 'right-class', onchange: () => show() }, el('option', { value: '' }, 'as it is'),
                  ...classesFor(object, model).map((info) => el('option', { value: info.iri }, model.titleOf(info))));
  const text = el('input', { type: 'text', id: 'remark', placeholder: 'such as: the old one by the gate', autocomplete: 'off', oninput: () => show() });
  const code = el('code', { class: 'statement' }), said = el('p', { class: 'note', role: 'status' });
  const copy = el('button', { type: 'button', class: 'plain', onclick: () => {
    void navigator.clipboard?.writeText(code.textContent ?? '').then(() => { copy.textContent = 'Copied'; }, () => {
      getSelection()?.selectAllChildren(code);
    });
  } }, 'Copy');
  const saveIt = service && el('button', { type: 'button', class: 'plain', onclick: () => {
    saved(service, object, code.textContent ?? '').then((told) => { said.textContent = told; }, (fault: Error) => { said.textContent = fault.message; });
  } }, 'Save in the map');
  const show = () => {
    const isEmpty = kind.value === '' && text.value.trim() === '';
    code.textContent = isEmpty ? '' : statementOf(object, kind.value, text.value.trim());
    said.textContent = isEmpty ? 'Choose a class or write a remark.' : '';
    code.hidden = copy.disabled = isEmpty;
    if (saveIt) saveIt.disabled = isEmpty;
  };
  show();
  return el('details', { class: 'correction' }, el('summary', {}, 'Wrong class, or something to say?'),
            el('label', { for: 'right-class', class: 'label' }, 'It is a'), kind,
            el('label', { for: 'remark', class: 'label' }, 'Remark'), text,
            el('p', { class: 'note' }, 'Run this with cluxel update MAP -e. It becomes an operator statement about the object, and queries see it. ' +
               'With a class the object is one of that class from then on: its rule is "operator", its confidence 1, and it gets another IRI.'),
            code, el('div', { class: 'row' }, copy, saveIt), said,
            service && el('p', { class: 'note' }, 'To save, the service needs its token: it stands in the panel Rules.'));
}

/** Saves a statement, and tells whom it is about. The map is asked before: the change that ended an object may be unknown yet. */
async function saved(service: Service, object: MapObject, statement: string): Promise<string> {
  const isThere = await service.has(object.iri);
  await service.post('sparql', 'application/sparql-update', statement);
  const about = isThere ? '' : ' The object has gone since this page was made: the statement is about what it went on as.';
  return `Saved as an operator statement.${about} This page shows the map as it was before: load it anew to see the statement.`;
}

/** The classes that an object may be stated to be of, as the service takes them: those below clx:Object. */
function classesFor(object: MapObject, model: MapModel): ClassInfo[] {
  if (object.class.whole) return [];
  return [...model.classes.values()].filter((info) => info.ancestors.includes(`${CLX}Object`) && !info.whole)
    .sort((a, b) => (model.titleOf(a) < model.titleOf(b) ? -1 : 1));
}

function statementOf(object: MapObject, kind: string, remark: string): string {
  const parts = [kind && `a <${kind}>`, remark && `<${LABEL}> ${JSON.stringify(remark)}@en`];
  return `INSERT DATA { <${object.iri}> ${parts.filter(Boolean).join(' ; ')} }`;
}
