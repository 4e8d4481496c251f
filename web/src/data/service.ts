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

  /** The service of a page that was fetched from one. */
  static of(model: MapModel): Service | undefined {
    return model.values.served && /^https?:$/.test(location.protocol) ? new Service() : undefined;
  }

  /** `path` is relative to the map: "tasks/route?from=0,0". */
  async text(path: string, init: RequestInit = {}): Promise<string> {
    return (await this.answer(path, init)).text();
  }

  async bytes(path: string): Promise<Uint8Array<ArrayBuffer>> {
    return new Uint8Array(await (await this.answer(path, {})).arrayBuffer());
  }

  private async answer(path: string, init: RequestInit): Promise<Response> {
    const response = await fetch(new URL(path, location.href.replace(/[?#].*$/s, '')), init);
    if (!response.ok) throw new Error((await response.text()).trim() || `The service answered ${response.status}.`);
    return response;
  }

  async json<T>(path: string, init: RequestInit = {}): Promise<T> {
    return JSON.parse(await this.text(path, init)) as T;
  }

  post(path: string, type: string, body: string): Promise<string> {
    return this.text(path, { method: 'POST', body, headers: { 'Content-Type': type, Authorization: `Bearer ${this.token}` } });
  }
}
