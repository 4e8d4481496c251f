#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `cluxel serve` under wrk: a minute at full speed, with the resident memory of its halves, and response times at 64
# connections and 200 requests a second.
# Usage: bench/serve.sh CLUXEL OUT [SECONDS [STOPS]]: a generated campus of STOPS scans (6); SECONDS of load (60).
set -euo pipefail
[ $# -ge 2 ] || { sed -n '5s/^# //p' "$0" >&2; exit 2; }
command -v wrk >/dev/null || { echo "serve.sh: wrk is missing; apt-get install wrk" >&2; exit 2; }
cluxel=$1 out=$2 seconds=${3:-60} stops=${4:-6}
mkdir -p "$out"
[ -d "$out/scans" ] || "$cluxel" simulate "$out/scans" --seed 31 --stops "$stops" >/dev/null
[ -f "$out/campus.clx" ] || "$cluxel" build "$out/scans" -o "$out/campus.clx" >/dev/null 2>&1

rm -f "$out/url"
"$cluxel" serve "$out/campus.clx" --port 0 --quiet >"$out/url" &
server=$!
trap 'kill $server 2>/dev/null || true' EXIT
until [ -s "$out/url" ]; do sleep 0.1; done
url=$(cat "$out/url")
question="${url}sparql?format=json&query=SELECT+*+%7B+?o+a+%3Chttps://w3id.org/cluxel/ontology%23StreetSign%3E+;+%3Chttps://w3id.org/cluxel/ontology%23height%3E+?h+%7D"

# 64 connections that wait 320 ms between requests are 200 requests a second.
cat >"$out/paced.lua" <<'LUA'
function delay() return 320 end
LUA
cat >"$out/report.lua" <<'LUA'
done = function(summary, latency)
  local e = summary.errors
  io.write(string.format("requests %d, a second %.0f, errors %d, median %.2f ms, p99 %.2f ms, longest %.2f ms\n",
    summary.requests, summary.requests / summary.duration * 1e6, e.connect + e.read + e.write + e.status + e.timeout,
    latency:percentile(50) / 1000, latency:percentile(99) / 1000, latency.max / 1000))
end
LUA
cat "$out/report.lua" >>"$out/paced.lua"

resident() { awk '/VmRSS/ {print $2}' "/proc/$server/status"; }
run() { wrk -t2 -c64 -d"$1s" -s "$2" "$question" | tail -n 1; }

run 2 "$out/report.lua" >/dev/null # fills caches
echo "paced: $(run $((seconds / 2)) "$out/paced.lua")"
run "$seconds" "$out/report.lua" >"$out/full" &
load=$!
for ((i = 0; i < seconds * 2; ++i)); do sleep 0.5; resident; done >"$out/resident"
wait $load
echo "full speed, $seconds s: $(cat "$out/full")"
awk '{ v[NR] = $1 } END { h = int(NR / 2); for (i = 1; i <= NR; ++i) { if (i <= h) a += v[i]; else b += v[i] }
  a /= h; b /= NR - h
  printf "resident memory: first half %.1f MiB, second half %.1f MiB, ratio %.3f\n", a / 1024, b / 1024, b / a }' "$out/resident"
kill -TERM $server
wait $server && echo "stopped with exit code 0"
