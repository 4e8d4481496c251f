#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Merging two maps of some generated scans each, with a border of a tenth of the area, against building the map of all.
# Usage: bench/merge_cost.sh CLUXEL OUT [RANGE]: RANGE of the laser [m] (47), which sets the width of the border
# ROUNDS (3): medians of so many. SCANS (19): of each map, on a campus of SIZE (100) metres. The aim is at most 0.20.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '4s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 range=${3:-47} here=$(dirname "$0") rounds=${ROUNDS:-3} each=${SCANS:-19} size=${SIZE:-100}
mkdir -p "$out"
scans=$out/scans_${each}_$range
[ -d "$scans" ] || "$cluxel" simulate "$scans" --seed 43 --city 2x1 --size "$size" --stops "$each" --max-range "$range" >/dev/null 2>&1

median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
seconds() { # seconds COMMAND...: the median of some rounds
  for ((i = 0; i < rounds; ++i)); do "$here/measured.py" "$@"; done | cut -d' ' -f1 | median
}
tiles() { # tiles SCANS... : of the map that they make, which is then OUT/NAME.clx
  "$cluxel" --threads 1 build "${@:2}" -o "$1" --force --json 2>/dev/null |
    python3 -c 'import json,sys; print(json.load(sys.stdin)["tiles"])'
}
a=$(tiles "$out/a.clx" "$scans/district_0000") b=$(tiles "$out/b.clx" "$scans/district_0001")
both=$(tiles "$out/both.clx" "$scans/district_0000" "$scans/district_0001")
rebuild=$(seconds "$cluxel" --threads 1 build "$scans"/district_* -o "$out/both.clx" --force)
merge=$(seconds "$cluxel" --threads 1 merge "$out/a.clx" "$out/b.clx" -o "$out/merged.clx" --force)
cmp <("$cluxel" export "$out/merged.clx" --canonical 2>/dev/null) <("$cluxel" export "$out/both.clx" --canonical 2>/dev/null)
awk -v a="$a" -v b="$b" -v all="$both" -v r="$rebuild" -v m="$merge" 'BEGIN {
  print "| tiles of both maps | in both | share | rebuild [s] | merge [s] | of the rebuild |\n|---|---|---|---|---|---|"
  printf "| %d | %d | %.3f | %.2f | %.2f | %.2f |\n", all, a + b - all, (a + b - all) / all, r, m, m / r }'
