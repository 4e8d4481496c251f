// SPDX-License-Identifier: Apache-2.0
// Asks oxigraph a batch of queries: node oxigraph_answers.mjs MODULE_FOLDER DATA.nq REQUESTS.json ANSWERS.json
// REQUESTS: [query]; ANSWERS: {milliseconds, answers: [{kind, text}]} in the same order.
import { webcrypto } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

globalThis.crypto ??= webcrypto;   // Node 18, which Debian 12 has, does not say it to modules

const [folder, dataFile, requestsFile, answersFile] = process.argv.slice(2);
const oxigraph = createRequire(folder + "/package.json")("oxigraph");
const store = new oxigraph.Store();
store.load(readFileSync(dataFile, "utf8"), { format: "application/n-quads" });

function answer(query) {
  const form = /\b(SELECT|ASK|CONSTRUCT)\b/.exec(query)[1];
  const format = form === "CONSTRUCT" ? "application/n-triples" : "application/sparql-results+json";
  return { kind: form, text: store.query(query, { results_format: format }) };
}

const started = performance.now();
const answers = JSON.parse(readFileSync(requestsFile, "utf8")).map((query) => {
  try {
    return answer(query);
  } catch (error) {
    return { kind: "ERROR", text: String(error.message ?? error) };
  }
});
writeFileSync(answersFile, JSON.stringify({ milliseconds: performance.now() - started, answers }));
