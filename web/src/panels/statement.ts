// SPDX-License-Identifier: Apache-2.0
// A statement of a person about an object: text for cluxel update to copy, or saved by the service.
import { capitalised, type ClassInfo, type MapModel, type MapObject } from '../data/model';
import type { Service } from '../data/service';
import { el } from '../dom';

const LABEL = 'http://www.w3.org/2000/01/rdf-schema#label';

export function statementForm(object: MapObject, model: MapModel, service: Service | undefined): HTMLElement {
  const classes: ClassInfo[] = [...model.classes.values()].sort((a, b) => (a.label < b.label ? -1 : 1));
  const kind = el('select', { id: 'right-class', onchange: () => show() }, el('option', { value: '' }, 'as it is'),
                  ...classes.map((info) => el('option', { value: info.iri }, capitalised(info.label))));
  const text = el('input', { type: 'text', id: 'remark', placeholder: 'the old one by the gate', autocomplete: 'off', oninput: () => show() });
  const code = el('code', { class: 'statement' }), said = el('p', { class: 'note', role: 'status' });
  const show = () => { code.textContent = statementOf(object, kind.value, text.value); };
  const copy = el('button', { type: 'button', class: 'plain', onclick: () => {
    void navigator.clipboard?.writeText(code.textContent ?? '').then(() => { copy.textContent = 'Copied'; }, () => {
      getSelection()?.selectAllChildren(code);
    });
  } }, 'Copy');
  const saveIt = service && el('button', { type: 'button', class: 'plain', onclick: () => {
    service.post('sparql', 'application/sparql-update', code.textContent ?? '').then(
      () => { said.textContent = 'Saved as an operator statement.'; },
      (fault: Error) => { said.textContent = fault.message; });
  } }, 'Save in the map');
  show();
  return el('details', { class: 'correction' }, el('summary', {}, 'Wrong class, or something to say?'),
            el('label', { for: 'right-class', class: 'label' }, 'It is a'), kind,
            el('label', { for: 'remark', class: 'label' }, 'Remark'), text,
            el('p', { class: 'note' }, 'Run this with cluxel update MAP -e. It becomes an operator statement about the object: queries see it, and the rules decide as before.'),
            code, el('div', { class: 'row' }, copy, saveIt), said,
            service && el('p', { class: 'note' }, 'To save, the service needs its token: it stands in the panel Rules.'));
}

function statementOf(object: MapObject, kind: string, remark: string): string {
  const parts = [kind && `a <${kind}>`, (remark || !kind) && `<${LABEL}> ${JSON.stringify(remark || 'what you know of it')}@en`];
  return `INSERT DATA { <${object.iri}> ${parts.filter(Boolean).join(' ; ')} }`;
}
