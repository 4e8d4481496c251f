#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Reads a map in all ways, each in a process of its own, and prints a table of processor time and memory (RssAnon).
# Usage: bench/memory.sh CLUXEL OUT MAP [TRUTH [FROM TO]]: a folder for what is written, the truth for `evaluate`
# (campus), and the ends of a route as `route` takes them. MAP is only read. SINCE: from when on scans are later, for
# `changes`. RULES: other rules, for `rules try`. ONLY: names of rows to measure, separated by spaces. Operations that
# find nothing (exit codes 1 and 3) count.
set -euo pipefail
[ $# -ge 3 ] || { sed -n '4s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 map=$3 truth=${4:-campus} from=${5:-} to=${6:-} here=$(dirname "$0")
mkdir -p "$out"

measure() { # measure NAME ARGUMENT...: a row of the table
  local name=$1 figures status=0
  shift
  [ -z "${ONLY:-}" ] || [[ " $ONLY " == *" $name "* ]] || return 0
  figures=$("$here/measured.py" --output "$out/$name.out" "$cluxel" --threads 1 "$@" 2>"$out/$name.err") || status=$?
  case $status in
    0 | 1 | 3) read -r cpu elapsed memory <<<"$figures" && echo "| $name | $cpu | $elapsed | $memory |" ;;
    *) echo "| $name | fails with exit code $status: $(head -n 1 "$out/$name.err") | | |" ;;
  esac
}

echo '| operation | processor time [s] | elapsed [s] | RssAnon [MB] |'
echo '|---|---|---|---|'
measure canonical export "$map" --canonical
measure nquads export "$map" --format nquads
measure turtle export "$map" --format turtle
measure dump dump "$map"
measure ply export "$map" -o "$out/points.ply"
measure geojson export "$map" --local -o "$out/footprints.geojson"
measure evaluate evaluate "$map" --truth "$truth"
measure info info "$map"
measure inventory inventory "$map"
measure changes changes "$map" ${SINCE:+--since "$SINCE"}
measure search search "$map" --for Vehicle
[ -z "$from" ] || measure route route "$map" "$from" "$to"
[ -z "$from" ] || measure reach reach "$map" "$from"
measure learn search learn "$map" -o "$out/places.ttl"
measure fit rules fit "$map" --truth "$truth" -o "$out/fitted.rules.yaml"
measure try rules try "$map" "${RULES:-$here/../rules/outdoor.rules.yaml}"
measure costmap costmap "$map" -o "$out/costs.pgm"
measure view view "$map" -o "$out/page.html"
