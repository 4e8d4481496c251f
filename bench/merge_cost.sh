#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Merging two maps, the west and the east half of a generated city, against building the map of all scans.
# Usage: bench/merge_cost.sh CLUXEL OUT [RANGE]: RANGE of the laser [m] (47), which sets the width of the border
# ROUNDS (3): medians of so many. CITY (2x1): columns and rows of districts of SIZE (100) metres with SCANS (19) each.
# The aim is at most 0.20 with a border of a tenth.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '4s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 range=${3:-47} here=$(dirname "$0")
rounds=${ROUNDS:-3} city=${CITY:-2x1} size=${SIZE:-100} each=${SCANS:-19}
columns=${city%x*}
mkdir -p "$out"
scans=$out/scans_${city}_${size}_${each}_$range
[ -d "$scans" ] || "$cluxel" simulate "$scans" --seed 43 --city "$city" --size "$size" --stops "$each" \
  --max-range "$range" >/dev/null 2>&1

median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
column() { cut -d' ' -f"$1" "$2" | median; }
measure() { # measure NAME COMMAND...: runs of it go to OUT/NAME.runs
  local name=$1
  shift
  for ((i = 0; i < rounds; ++i)); do "$here/measured.py" "$@"; done >"$out/$name.runs"
}
tiles() { # tiles MAP SCANS... : of the map that they make
  "$cluxel" --threads 1 build "${@:2}" -o "$1" --force --json 2>/dev/null |
    python3 -c 'import json,sys; print(json.load(sys.stdin)["tiles"])'
}
west=() east=()
for district in "$scans"/district_*; do
  number=$((10#${district##*_}))
  if ((number % columns < columns / 2)); then west+=("$district"); else east+=("$district"); fi
done
a=$(tiles "$out/a.clx" "${west[@]}") b=$(tiles "$out/b.clx" "${east[@]}") both=$(tiles "$out/both.clx" "$scans"/district_*)
measure rebuild "$cluxel" --threads 1 build "$scans"/district_* -o "$out/both.clx" --force
measure merge "$cluxel" --threads 1 merge "$out/a.clx" "$out/b.clx" -o "$out/merged.clx" --force
cmp <("$cluxel" export "$out/merged.clx" --canonical 2>/dev/null) <("$cluxel" export "$out/both.clx" --canonical 2>/dev/null)
points=$("$cluxel" info "$out/both.clx" --json 2>/dev/null | python3 -c 'import json,sys; print(json.load(sys.stdin)["points"] / 1e6)')
awk -v p="$points" -v a="$a" -v b="$b" -v all="$both" -v r="$(column 1 "$out/rebuild.runs")" \
  -v m="$(column 1 "$out/merge.runs")" -v memory="$(column 3 "$out/merge.runs")" 'BEGIN {
  print "| points [millions] | tiles of both maps | in both | share | rebuild [s] | merge [s] | of the rebuild | merge: RssAnon [MB] |"
  print "|---|---|---|---|---|---|---|---|"
  printf "| %.1f | %d | %d | %.3f | %.2f | %.2f | %.2f | %d |\n", p, all, a + b - all, (a + b - all) / all, r, m, m / r, memory }'
