#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Points to objects in the file: points a second a core, the share of each stage, and the gain of a second thread.
# Usage: bench/two_threads.sh CLUXEL OUT [OAKLAND]: a dense generated campus, and Oakland's labelled text in that folder
# ROUNDS (5): builds with one and two threads in turn, of which the medians count. Run it on a quiet machine: the gain is
# a ratio of elapsed times. The aims: 0.6 M points/s a core on the campus and 0.25 on Oakland, reasoning (`objects`) at
# most 15 %, two threads 1.7 times one.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '4s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 oakland=${3:-} here=$(dirname "$0") rounds=${ROUNDS:-5}
mkdir -p "$out"
[ -d "$out/campus" ] || "$cluxel" simulate "$out/campus" --seed 1 >/dev/null 2>&1

measure() { # measure NAME SCANS...
  local name=$1 map=$out/$1.clx
  shift
  : >"$out/$name.runs"
  for ((i = 0; i < rounds; ++i)); do
    for threads in 1 2; do
      {
        printf '%s ' "$threads"
        rm -f "$map" "$map-lock"  # a map that is replaced is read and freed by one thread
        "$here/measured.py" "$cluxel" --threads "$threads" build "$@" -o "$map" | tr '\n' ' '
        "$cluxel" info "$map" --json 2>/dev/null |
          python3 -c 'import json,sys; d = json.load(sys.stdin); print(json.dumps([d["points"], d["runs"][-1]]))'
      } >>"$out/$name.runs"
    done
  done
  python3 - "$name" "$out/$name.runs" <<'PY'
import json, statistics, sys
runs = []
for line in open(sys.argv[2]):
    threads, cpu, elapsed, memory, rest = line.split(" ", 4)
    runs.append((int(threads), float(cpu), float(elapsed), int(memory), *json.loads(rest)))
one, two = ([run for run in runs if run[0] == threads] for threads in (1, 2))
median = lambda rows, column: statistics.median(row[column] for row in rows)
points, seconds = one[0][4], median(one, 1)
print(f"| {sys.argv[1]} | {points} | {seconds:.2f} | {points / seconds / 1e6:.3f} | {median(one, 3)} "
      f"| {median(one, 2):.2f} | {median(two, 2):.2f} | {median(one, 2) / median(two, 2):.2f} | {median(two, 1) / seconds:.2f} |")
shares = {}
for run in one:
    for stage in run[5]["stages"]:
        shares.setdefault(stage["stage"], []).append(stage["seconds"] / run[5]["seconds"])
print(", ".join(f"{name} {100 * statistics.median(values):.1f}" for name, values in shares.items()), file=sys.stderr)
PY
}

echo '| data | points | processor time, 1 thread [s] | M points/s a core | RssAnon [MB] | elapsed, 1 thread [s] | 2 threads [s] | gain | processor time of 2 threads over 1 |'
echo '|---|---|---|---|---|---|---|---|---|'
measure campus "$out/campus" 2>"$out/campus.shares"
[ -z "$oakland" ] || measure oakland "$oakland"/*.xyz_label_conf 2>"$out/oakland.shares"
for shares in "$out"/*.shares; do echo && echo "Stages of $(basename "$shares" .shares) [% of elapsed time, 1 thread]: $(cat "$shares")"; done
