// SPDX-License-Identifier: Apache-2.0
// The service that a served page comes from: tasks, reasons, trials of rules, statements. A file has none.
import type { MapModel } from './model';

export interface TaskShape { type: 'Point' | 'LineString' | 'MultiPolygon'; coordinates: unknown }
export interface TaskColumn { name: string; unit: string; help: string }
export type TaskRow = Record<string, unknown> & { geometry?: TaskShape; why?: string[]; way?: number[][] };
export interface TaskAnswer { columns: TaskColumn[]; rows: TaskRow[]; notes: string[] }

export class Service {
  /** The token for updates and trials; never stored. */
  token = '';
  /** Whether an answer came from another state of the map than the page's. It stays so until the page is loaded anew. */
  hasChanged = false;
  /** Called once, when it has. */
  onChange: () => void = () => {};

  private constructor(private readonly state: string) {}

  /** The service of a page that was fetched from one. */
  static of(model: MapModel): Service | undefined {
    return model.values.served && /^https?:$/.test(location.protocol) ? new Service(model.values.state ?? '') : undefined;
  }

  /** `path` is relative to the map: "tasks/route?from=0,0". */
  async text(path: string, init: RequestInit = {}): Promise<string> {
    return (await this.answer(path, init)).text();
  }

  async bytes(path: string): Promise<Uint8Array<ArrayBuffer>> {
    return new Uint8Array(await (await this.answer(path, {})).arrayBuffer());
  }

  /** Whether the map as it is now has the object. */
  async has(iri: string): Promise<boolean> {
    return (await this.json<{ boolean: boolean }>(`sparql?format=json&query=${encodeURIComponent(`ASK { <${iri}> a ?class }`)}`)).boolean;
  }

  /** What to say beside an answer: empty while the map is the page's. */
  get note(): string {
    return this.hasChanged ? 'This is of the map as it is now, which has changed since this page was made.' : '';
  }

  private async answer(path: string, init: RequestInit): Promise<Response> {
    const response = await fetch(new URL(path, location.href.replace(/[?#].*$/s, '')), init);
    this.compare(response.headers.get('Cluxel-State'));
    if (!response.ok) throw new Error((await response.text()).trim() || `The service answered ${response.status}.`);
    return response;
  }

  /**
   * An answer without a state, as of a server before the service, tells nothing of the map, and so does one for which the
   * file could not be read.
   */
  private compare(state: string | null): void {
    if (state === null || state === 'unknown' || state === this.state || this.hasChanged) return;
    this.hasChanged = true;
    this.onChange();
  }

  async json<T>(path: string, init: RequestInit = {}): Promise<T> {
    return JSON.parse(await this.text(path, init)) as T;
  }

  post(path: string, type: string, body: string): Promise<string> {
    return this.text(path, { method: 'POST', body, headers: { 'Content-Type': type, Authorization: `Bearer ${this.token}` } });
  }
}
