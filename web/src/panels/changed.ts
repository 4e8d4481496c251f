// SPDX-License-Identifier: Apache-2.0
// Says that the map has changed under a served page, and loads the page anew. What the page holds stays as it was made.
import type { Service } from '../data/service';
import { el } from '../dom';

export function changedBanner(service: Service | undefined): HTMLElement | '' {
  if (!service) return '';
  const banner = el('div', { class: 'changed', role: 'alert' });
  service.onChange = () => banner.replaceChildren(
    el('p', {}, 'The map has changed since this page was made. The picture, the objects, questions and visits are of the map as it was. ' +
                'Tasks, lineages, tried rules and "why not" are of the map as it is now.'),
    el('button', { type: 'button', class: 'primary', onclick: () => location.reload() }, 'Load the page anew'));
  return banner;
}
