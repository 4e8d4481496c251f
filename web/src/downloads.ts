// SPDX-License-Identifier: Apache-2.0
// Answers as files: CSV as the SPARQL recommendation writes it, GeoJSON in metres of the map frame.
import type { MapModel, MapObject, Box } from './data/model';
import type { RdfTerm, Rows } from './sparql/answers';

function cellText(term: RdfTerm | null): string {
  if (!term) return '';
  return term.kind === 'blank' ? `_:${term.value}` : term.value;
}

function csvField(text: string): string {
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export function csvOf(answer: Rows): string {
  const lines = [answer.variables.map(csvField), ...answer.rows.map((row) => row.map((term) => csvField(cellText(term))))];
  return lines.map((fields) => `${fields.join(',')}\r\n`).join('');
}

function ringOf(box: Box): number[][] {
  const along = [Math.cos(box.yaw), Math.sin(box.yaw)], half = [0.5 * box.length, 0.5 * box.width];
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]];
  return corners.map(([a, b]) => [
    Number((box.x + a * half[0] * along[0] - b * half[1] * along[1]).toFixed(3)),
    Number((box.y + a * half[0] * along[1] + b * half[1] * along[0]).toFixed(3)),
  ]);
}

/** One feature for each row; its geometry is null where the row names no object. */
export function geoJsonOf(answer: Rows, objectOfRow: (row: number) => MapObject | undefined, model: MapModel): string {
  const features = answer.rows.map((row, i) => {
    const object = objectOfRow(i);
    const properties = Object.fromEntries(answer.variables.map((name, k) => [name, cellText(row[k])]));
    if (!object) return { type: 'Feature', geometry: null, properties };
    return {
      type: 'Feature', id: object.id, geometry: { type: 'Polygon', coordinates: [ringOf(object.box)] },
      properties: { ...properties, class: object.class.label, iri: object.iri },
    };
  });
  return JSON.stringify({
    type: 'FeatureCollection', frame: 'map frame of Cluxel, metres: not longitude and latitude',
    crs_of_origin: model.values.crs, origin: model.values.origin, features,
  }, null, 1);
}

/** Hands a file to the browser. */
export function save(name: string, type: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
