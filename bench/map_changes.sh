#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The cost of changing a map against building it: processor seconds, and ratios to the build from all scans.
# Usage: bench/map_changes.sh CLUXEL OUT [STOPS [SIZE]]: a generated campus of STOPS scans (24) on SIZE metres (150).
set -euo pipefail
[ $# -ge 2 ] || { sed -n '4s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 stops=${3:-24} size=${4:-150}
mkdir -p "$out"
scans=$out/scans
[ -d "$scans" ] || "$cluxel" simulate "$scans" --seed 31 --stops "$stops" --size "$size" >/dev/null
last=$(printf 'scan_%03d.pcd' $((stops - 1)))

# All scans but the last, as a folder of its own.
most=$out/most
rm -rf "$most"
mkdir "$most"
for file in "$scans"/scan_*.pcd; do [ "$(basename "$file")" = "$last" ] || ln -s "$(realpath "$file")" "$most/"; done
grep -v '^#' "$scans/poses.txt" | head -n $((stops - 1)) >"$most/poses.txt"
head -n $((stops - 1)) "$scans/times.txt" >"$most/times.txt"

seconds() {  # seconds COMMAND...: user and system time
  local TIMEFORMAT='%U %S'
  { time "$@" >/dev/null 2>&1; } 2>&1 | awk '{print $1 + $2}'
}
row() {  # row NAME SECONDS
  awk -v name="$1" -v s="$2" -v all="$all" 'BEGIN { printf "| %s | %.2f | %.2f |\n", name, s, s / all }'
}

map=$out/map.clx
all=$(seconds "$cluxel" --threads 1 build "$scans" -o "$out/all.clx" --force)
printf '| operation | processor time [s] | of the build |\n|---|---|---|\n'
row "build from $stops scans" "$all"
"$cluxel" build "$most" -o "$map" --force >/dev/null 2>&1
row "extend by the last scan" "$(seconds "$cluxel" --threads 1 extend "$map" "$scans")"
cmp <("$cluxel" export "$map" --canonical 2>/dev/null) <("$cluxel" export "$out/all.clx" --canonical 2>/dev/null)
row "retract it" "$(seconds "$cluxel" --threads 1 retract "$map" "$last")"
sed 's/bush_top: 1.7 m/bush_top: 1.3 m/' "$(dirname "$0")/../rules/outdoor.rules.yaml" >"$out/other.rules.yaml"
row "apply rules with another threshold" "$(seconds "$cluxel" --threads 1 rules apply "$map" --rules "$out/other.rules.yaml")"
ls -l "$map" "$out/all.clx" | awk '{ print "| bytes of " $NF " | " $5 " | |" }'
