// SPDX-License-Identifier: Apache-2.0
// Asks oxigraph a batch of queries: node oxigraph_answers.mjs MODULE_FOLDER DATA.nq REQUESTS.json ANSWERS.json
// REQUESTS: [{query, default_graphs?, named_graphs?}]; ANSWERS: [{kind, text, rows?}] in the same order.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const [folder, dataFile, requestsFile, answersFile] = process.argv.slice(2);
const oxigraph = createRequire(folder + "/package.json")("oxigraph");
const store = new oxigraph.Store();
store.load(readFileSync(dataFile, "utf8"), { format: "application/n-quads" });

const graphOf = (iri) => (iri === "" ? oxigraph.defaultGraph() : oxigraph.namedNode(iri));

function optionsOf(request) {
  const options = {};
  if (request.default_graphs) options.default_graph = request.default_graphs.map(graphOf);
  if (request.named_graphs) options.named_graphs = request.named_graphs.map(graphOf);
  return options;
}

function answer(request) {
  const text = request.query;
  const form = /\b(SELECT|ASK|CONSTRUCT)\b/.exec(text)[1];
  const format = form === "CONSTRUCT" ? "application/n-triples" : "application/sparql-results+json";
  return { kind: form, text: store.query(text, { ...optionsOf(request), results_format: format }) };
}

const started = performance.now();
const answers = JSON.parse(readFileSync(requestsFile, "utf8")).map((request) => {
  try {
    return answer(request);
  } catch (error) {
    return { kind: "ERROR", text: String(error.message ?? error) };
  }
});
writeFileSync(answersFile, JSON.stringify({ milliseconds: performance.now() - started, answers }));
