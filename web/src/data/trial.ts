// SPDX-License-Identifier: Apache-2.0
// What other rules would change, as cluxel rules try --json tells it.

export interface Judged { id: string; class: string; confidence: number; rule: string }
export interface TrialChange {
  kind: 'class' | 'parts' | 'confidence' | 'rule' | 'added' | 'removed';
  before: Judged | null;
  after: Judged | null;
  place: number[];
  points: number;
}
export interface Trial {
  before: number;
  after: number;
  counts: Record<TrialChange['kind'], number>;
  changes: TrialChange[];
}
