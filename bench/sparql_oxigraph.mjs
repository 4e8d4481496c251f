// SPDX-License-Identifier: Apache-2.0
// The questions of the comparison put to oxigraph's in-memory store: node sparql_oxigraph.mjs MODULE DATA.nt REQUESTS ANSWERS
// Each answer: {name, seconds of the median run, rows as lines of TSV}; a question that takes longer than half a minute
// is given up and counted with that time.
import { webcrypto } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { isMainThread, parentPort, Worker, workerData } from "node:worker_threads";

globalThis.crypto ??= webcrypto;   // Node 18, which Debian 12 has, does not say it to modules

const mostSeconds = 5, givenUpAfterSeconds = 30;

function loadedStore(oxigraph, dataFile) {
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
  return store;
}

function lines(text) {
  if (typeof text === "boolean") return 1;
  let count = 0;
  for (let at = text.indexOf("\n"); at >= 0; at = text.indexOf("\n", at + 1)) ++count;
  return count;
}

function measured(store, query) {
  const seconds = [];
  let rows = 0;
  const start = performance.now();
  while (seconds.length < 5 || (seconds.length < 200 && performance.now() - start < 400)) {
    const begin = performance.now();
    const text = store.query(query, { results_format: /\bASK\b/.test(query) ? undefined : "text/tab-separated-values" });
    seconds.push((performance.now() - begin) / 1000);
    rows = lines(text);
    if (performance.now() - start > mostSeconds * 1000) break;
  }
  seconds.sort((a, b) => a - b);
  return { seconds: seconds[seconds.length >> 1], rows };
}

function serve({ folder, dataFile }) {
  const store = loadedStore(createRequire(folder + "/package.json")("oxigraph"), dataFile);
  parentPort.on("message", (query) => {
    try {
      parentPort.postMessage(measured(store, query));
    } catch (error) {
      parentPort.postMessage({ seconds: -1, rows: 0, error: String(error.message ?? error) });
    }
  });
  parentPort.postMessage("ready");
}

const nextMessage = (worker, milliseconds) =>
  new Promise((resolve) => {
    const timer = setTimeout(() => resolve(null), milliseconds);
    worker.once("message", (message) => {
      clearTimeout(timer);
      resolve(message);
    });
  });

async function main() {
  const [folder, dataFile, requestsFile, answersFile] = process.argv.slice(2);
  const started = async () => {
    const worker = new Worker(new URL(import.meta.url), { workerData: { folder, dataFile }, resourceLimits: { maxOldGenerationSizeMb: 8000 } });
    await nextMessage(worker, 600_000);
    return worker;
  };
  let worker = await started();
  const answers = [];
  for (const { name, query } of JSON.parse(readFileSync(requestsFile, "utf8"))) {
    worker.postMessage(query);
    const answer = await nextMessage(worker, givenUpAfterSeconds * 1000);
    if (answer === null) {
      answers.push({ name, seconds: givenUpAfterSeconds, rows: 0, given_up: true });
      await worker.terminate();
      worker = await started();
    } else {
      if (answer.error) console.error(name, answer.error);
      answers.push({ name, ...answer });
    }
    writeFileSync(answersFile, JSON.stringify(answers));
  }
  await worker.terminate();
}

if (isMainThread) await main();
else serve(workerData);
