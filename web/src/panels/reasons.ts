// SPDX-License-Identifier: Apache-2.0
// Why an object has its class, and why not another: the tests of the rules with measured values and margins.
import { capitalised, CLX, type EvidenceLine, type MapModel, type Reasons, type Step, type Verdict } from '../data/model';
import { el, rounded } from '../dom';
import type { Store } from '../state';

function withUnit(value: number, unit: string): string {
  return `${rounded(value)}${unit ? ` ${unit === 'deg' ? '°' : unit}` : ''}`;
}

/** The measured value as a place relative to its threshold: the bar ends at twice the threshold or the value. */
function gauge(step: Step): HTMLElement | null {
  if (step.measured === undefined || step.threshold === undefined) return null;
  const reach = Math.max(Math.abs(step.measured), 1.6 * Math.abs(step.threshold), 1e-9);
  const percent = (value: number) => `${(100 * Math.min(1, Math.max(0, Math.abs(value) / reach))).toFixed(1)}%`;
  return el('span', { class: 'gauge', 'aria-hidden': 'true' },
            el('span', { class: 'gauge-value', style: `width:${percent(step.measured)}` }),
            el('span', { class: 'gauge-limit', style: `left:${percent(step.threshold)}` }));
}

/** Names of classes in a text as people read them. */
function readable(text: string, model: MapModel): string {
  return text.replace(/\bclx:(\w+)/g, (_, name: string) => model.classOf(CLX + name).label).replaceAll('_', ' ');
}

/** The line of the rule file; a button where the panel of rules can show it. */
function placeOf(step: Step, store?: Store): HTMLElement {
  const text = `${step.file}:${step.line}`;
  if (!store) return el('small', { class: 'place' }, text);
  return el('button', { type: 'button', class: 'place', title: 'Show this line of the rules',
                        onclick: () => store.set('ruleLine', { file: step.file, line: step.line }) }, text);
}

/** How far the measured value is from the threshold. */
function marginText({ measured, threshold, unit }: Step): string {
  return measured === undefined || threshold === undefined ? '' : `margin ${withUnit(Math.abs(measured - threshold), unit)}`;
}

function stepRow(step: Step, store?: Store): HTMLElement {
  const measured = step.measured === undefined ? '' : `measured ${withUnit(step.measured, step.unit)}`;
  const margin = marginText(step);
  return el('li', { class: step.passed ? 'step yes' : 'step no' },
            el('span', { class: 'mark', role: 'img', 'aria-label': step.passed ? 'holds' : 'does not hold' }, step.passed ? '✓' : '✗'),
            el('span', { class: 'step-text' }, step.test.replaceAll('_', ' '),
               (measured || margin) && el('small', {}, [measured, margin].filter(Boolean).join(', ')), gauge(step),
               placeOf(step, store)));
}

function leastChange(verdict: Verdict, model: MapModel): HTMLElement | null {
  const change = verdict.least_change;
  if (!change) return null;
  const needed = change.changes.map((one) =>
    `${one.test.replaceAll('_', ' ')} turns at ${withUnit(one.threshold, one.unit)} (now ${withUnit(one.measured, one.unit)})`);
  return el('p', { class: 'least-change' }, el('b', {}, 'Least change: '), `${needed.join(', and ')}; then the rule says: ${readable(change.outcome, model)}`);
}

function signed(logOdds: number): string {
  return `${logOdds < 0 ? '−' : '+'}${rounded(Math.abs(logOdds))}`;
}

function evidenceRow(line: EvidenceLine): HTMLElement {
  const measured = line.holds !== undefined ? (line.holds ? 'holds' : 'does not hold')
                 : line.measured !== undefined ? withUnit(line.measured, line.unit) : 'not measured';
  return el('tr', {}, el('td', { class: 'log-odds' }, signed(line.log_odds)), el('td', {}, line.of.replaceAll('_', ' ')), el('td', {}, measured));
}

/** The log-odds line by line, and the candidates that wanted the same points. */
function evidenceView(verdict: Verdict, model: MapModel): HTMLElement | null {
  const lines = verdict.evidence ?? [], rivals = verdict.rivals ?? [];
  if (lines.length < 2 && rivals.length === 0) return null;
  const sum = `${signed(verdict.log_odds ?? 0)} in all: ${Math.round(100 * (verdict.probability ?? 0))} %`;
  return el('details', { class: 'evidence' },
            el('summary', {}, 'Evidence', el('small', {}, ` log-odds ${sum}`)),
            el('table', { 'aria-label': 'What each line of evidence adds to the log-odds' },
               el('tbody', {}, ...lines.map(evidenceRow))),
            ...rivals.map((rival) => el('p', { class: 'rival' },
              `${rival.won ? 'Stronger' : 'Weaker'} rival: ${readable(rival.class, model)} by ${rival.rule}, log-odds ${signed(rival.log_odds)}`)));
}

export function verdictBody(verdict: Verdict, model: MapModel, store?: Store): Node[] {
  const steps = (verdict.path ?? []).map((step) => stepRow(step, store));
  return [el('p', { class: 'verdict' }, capitalised(readable(verdict.reason, model)), el('small', {}, ` rule ${verdict.rule}`)),
          evidenceView(verdict, model), el('ul', { class: 'steps' }, ...steps), leastChange(verdict, model)].filter((node): node is HTMLElement => node !== null);
}

export function reasonsView(reasons: Reasons, model: MapModel, question: HTMLElement, store: Store): HTMLElement {
  const labelOf = (name: string) => capitalised(model.classOf(name.replace(/^clx:/, CLX)).label);
  const all = reasons.decisions ?? [], accepted = all.filter((verdict) => verdict.accepted);
  const rejected = all.filter((verdict) => !verdict.accepted);
  return el('div', { class: 'reasons' },
            reasons.note && el('p', { class: 'note' }, capitalised(reasons.note), '.'),
            ...accepted.map((verdict) => el('details', { open: true, class: 'why' },
                                            el('summary', {}, `Why ${labelOf(verdict.class)}?`), ...verdictBody(verdict, model, store))),
            rejected.length > 0 && el('h3', {}, 'Why nothing else?'),
            ...rejected.map((verdict) => el('details', { class: 'why-not' },
                                            el('summary', {}, `Not ${labelOf(verdict.class)}`, el('small', {}, ` ${readable(verdict.reason, model)}`)),
                                            ...verdictBody(verdict, model, store))), question);
}
