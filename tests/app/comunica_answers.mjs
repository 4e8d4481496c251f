// SPDX-License-Identifier: Apache-2.0
// Asks a SPARQL endpoint through the npm client @comunica/query-sparql:
// node comunica_answers.mjs MODULE_FOLDER ENDPOINT QUERIES.json ANSWERS.json
// An answer is a list of rows (values by variable), true or false, or a number of triples.
import fs from "node:fs";
import { createRequire } from "node:module";

const [folder, endpoint, queries, answers] = process.argv.slice(2);
const { QueryEngine } = createRequire(folder + "/package.json")("@comunica/query-sparql");
const engine = new QueryEngine();

async function answer(text) {
  const result = await engine.query(text, { sources: [{ type: "sparql", value: endpoint }] });
  if (result.resultType === "boolean") return result.execute();
  const stream = await result.execute();
  const items = await stream.toArray();
  if (result.resultType === "quads") return items.length;
  return items.map((row) => Object.fromEntries([...row].map(([variable, term]) => [variable.value, term.value])));
}

const all = [];
for (const text of JSON.parse(fs.readFileSync(queries, "utf8"))) all.push(await answer(text));
fs.writeFileSync(answers, JSON.stringify(all));
