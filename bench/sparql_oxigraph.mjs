// SPDX-License-Identifier: Apache-2.0
// The questions of the comparison put to oxigraph's in-memory store: node sparql_oxigraph.mjs MODULE DATA.nt REQUESTS ANSWERS
// Each answer: {name, seconds of the median run, rows as lines of TSV}.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const [folder, dataFile, requestsFile, answersFile] = process.argv.slice(2);
const oxigraph = createRequire(folder + "/package.json")("oxigraph");
const store = new oxigraph.Store();
// One string cannot hold a large file; lines are handed over in pieces.
const data = readFileSync(dataFile);
const piece = 32 << 20;
for (let begin = 0; begin < data.length; ) {
  let end = Math.min(begin + piece, data.length);
  if (end < data.length) end = data.lastIndexOf(10, end) + 1;
  store.load(data.subarray(begin, end).toString("utf8"), { format: "application/n-triples" });
  begin = end;
}

const mostSeconds = 10;
function lines(text) {
  let count = 0;
  for (let at = text.indexOf("\n"); at >= 0; at = text.indexOf("\n", at + 1)) ++count;
  return count;
}

function measured(query) {
  const seconds = [];
  let rows = 0;
  const start = performance.now();
  while (seconds.length < 5 || (seconds.length < 200 && performance.now() - start < 400)) {
    const begin = performance.now();
    const text = store.query(query, { results_format: "text/tab-separated-values" });
    seconds.push((performance.now() - begin) / 1000);
    rows = lines(text);
    if (performance.now() - start > mostSeconds * 1000) break;
  }
  seconds.sort((a, b) => a - b);
  return { seconds: seconds[seconds.length >> 1], rows };
}

const answers = JSON.parse(readFileSync(requestsFile, "utf8")).map(({ name, query }) => {
  try {
    return { name, ...measured(query) };
  } catch (error) {
    console.error(name, String(error.message ?? error));
    return { name, seconds: -1, rows: 0 };
  }
});
writeFileSync(answersFile, JSON.stringify(answers));
