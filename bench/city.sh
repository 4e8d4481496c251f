#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A generated city goes into a map in parts: districts are simulated, added and deleted. Memory and cost must not follow
# the size of the map. A part is built or added in one run of the program; with --batch it commits by so many points.
# Usage: bench/city.sh CLUXEL OUT [--points MILLIONS] [--part DISTRICTS] [--columns N] [--threads N] [--batch POINTS] [--seed N]
# Defaults: 20 million points, parts of 4 districts (2.1 million points each), 12 columns, 1 thread, seed 1.
set -euo pipefail
usage() { sed -n '5,6s/^# //p' "$0" >&2; exit 2; }
[ $# -ge 2 ] || usage
cluxel=$1 out=$2 points=20 part=4 columns=12 threads=1 seed=1 batch=()
shift 2
while [ $# -gt 0 ]; do
  [ $# -ge 2 ] || usage
  case $1 in
    --points) points=$2 ;;
    --part) part=$2 ;;
    --columns) columns=$2 ;;
    --threads) threads=$2 ;;
    --batch) batch=(--batch-points "$2") ;;
    --seed) seed=$2 ;;
    *) usage ;;
  esac
  shift 2
done
measured=$(dirname "$0")/measured.py
districts=$(awk -v p="$points" 'BEGIN { n = int(p / 2.1 + 0.5); print n < 1 ? 1 : n }')
rows=$(((districts + columns - 1) / columns))
mkdir -p "$out"
map=$out/city.clx scans=$out/scans
rm -rf "$scans" "$map"

number() { python3 -c 'import json,sys; print(json.load(sys.stdin)[sys.argv[1]])' "$1"; }

echo "| points [millions] | this part: seconds a million points | all parts: seconds a million points | peak RssAnon [MB] | file: bytes a point | tiles changed of tiles |"
echo '|---|---|---|---|---|---|'
total_s=0 total=0 peak=0
for ((first = 0; first < districts; first += part)); do
  last=$((first + part < districts ? first + part - 1 : districts - 1))
  added=$("$cluxel" --threads 2 simulate "$scans" --seed "$seed" --city "${columns}x$rows" --districts "$first..$last" \
    --json 2>/dev/null | number points)
  if [ "$first" -eq 0 ]; then
    command=(build "$scans"/district_* -o "$map" --force)
  else
    command=(extend "$map" "$scans"/district_*)
  fi
  line=$("$measured" --output "$out/report.json" "$cluxel" --threads "$threads" "${command[@]}" "${batch[@]}" --json)
  read -r seconds _ memory <<<"$line"
  rm -rf "$scans"
  total=$((total + added)) peak=$((memory > peak ? memory : peak))
  total_s=$(awk -v a="$total_s" -v b="$seconds" 'BEGIN { print a + b }')
  tiles=$(python3 -c 'import json,sys; r = json.load(open(sys.argv[1])); print(r.get("tiles_changed", r["tiles"]), "of", r["tiles"])' "$out/report.json")
  awk -v n="$total" -v a="$added" -v s="$seconds" -v t="$total_s" -v m="$peak" -v b="$(stat -c %s "$map")" -v tiles="$tiles" \
    'BEGIN { printf "| %.1f | %.2f | %.2f | %d | %.1f | %s |\n", n / 1e6, s / a * 1e6, t / n * 1e6, m, b / n, tiles }'
done
