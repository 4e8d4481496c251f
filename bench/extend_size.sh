#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One and the same scan is added to maps of growing size. Its cost must not follow the size of the map, and be at most
# 1.3 times what the tiles that it changes cost from scratch.
# Usage: bench/extend_size.sh CLUXEL OUT [MILLIONS...]: sizes of maps in millions of points (1 2 5 10 20)
# The city's districts have 12 scans of 80,000 points with a range of 30 m, so that no other district reaches the tiles of
# the scan. Columns "share": tiles changed as a share of all tiles, times the cost of the whole build. Columns "cut": the
# build of a map from all points of the changed tiles alone, from bench/cut_tiles.py. Then the same scan gets a pose that
# is off by half a metre, and is retracted. ROUNDS (3): medians of so many.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '5s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 here=$(dirname "$0") rounds=${ROUNDS:-3}
shift 2
[ $# -gt 0 ] || set -- 1 2 5 10 20
mkdir -p "$out"
map=$out/map.clx last=scan_0000_011

median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
median_of() { cut -d' ' -f"$2" "$out/$1" | median; } # median_of FILE COLUMN: of what bench/measured.py printed
scans_of() { # scans_of DISTRICTS: simulates what is missing of the first districts
  for ((number = 0; number < $1; ++number)); do
    local name
    name=$(printf 'district_%04d' "$number")
    [ -d "$out/$name" ] && continue
    rm -rf "$out/new"
    "$cluxel" simulate "$out/new" --seed 41 --city 10x6 --districts "$number..$number" --size 140 --stops 12 \
      --points-per-stop 80000 --max-range 30 >/dev/null 2>&1
    mv "$out/new/$name" "$out/"
  done
  rm -rf "$out/new"
}
scans_of 1

# The first district without its last scan, and that scan alone.
rm -rf "$out/most" "$out/last"
mkdir "$out/most" "$out/last"
for file in "$out"/district_0000/scan_*.pcd; do
  part=most
  [ "$(basename "$file")" != "$last.pcd" ] || part=last
  ln -s "$(realpath "$file")" "$out/$part/"
done
for table in poses times; do
  grep -v '^#' "$out/district_0000/$table.txt" | head -n 11 >"$out/most/$table.txt"
  grep -v '^#' "$out/district_0000/$table.txt" | tail -n 1 >"$out/last/$table.txt"
done

rm -rf "$out/moved"
cp -r "$out/last" "$out/moved"
awk '{ $4 += 0.5; print }' CONVFMT=%.17g OFMT=%.17g "$out/last/poses.txt" >"$out/moved/poses.txt"

rm -rf "$out/cut"
"$here/cut_tiles.py" "$out/cut" "$out/last/$last.pcd" "$out"/most/*.pcd "$out/last/$last.pcd" >/dev/null
cut=$(for ((i = 0; i < rounds; ++i)); do
  "$here/measured.py" "$cluxel" --threads 1 build "$out/cut" -o "$out/cut.clx" --force
done | cut -d' ' -f1 | median)

echo "| map: points [millions] | build [s] | build: RssAnon [MB] | extend [s] | extend: RssAnon [MB] | tiles changed of tiles | of the share | of the cut ($cut s) | repose: of the cut | repose: RssAnon [MB] | retract: of the cut | retract: RssAnon [MB] |"
echo '|---|---|---|---|---|---|---|---|---|---|---|---|'
for millions in "$@"; do
  districts=$(awk -v m="$millions" 'BEGIN { n = int(m / 0.96 + 0.5); print n < 1 ? 1 : n }')
  scans_of "$districts"
  inputs=("$out/most")
  for ((number = 1; number < districts; ++number)); do inputs+=("$out/$(printf 'district_%04d' "$number")"); done
  line=$("$here/measured.py" "$cluxel" --threads 1 build "${inputs[@]}" -o "$out/before.clx" --force)
  read -r build_s _ build_mb <<<"$line"
  : >"$out/extensions" && : >"$out/moves" && : >"$out/retractions"
  for ((i = 0; i < rounds; ++i)); do
    cp "$out/before.clx" "$map"
    "$here/measured.py" --output "$out/report.json" "$cluxel" --threads 1 extend "$map" "$out/last" --json >>"$out/extensions"
    cp "$map" "$out/extended.clx"
    "$here/measured.py" "$cluxel" --threads 1 repose "$map" "$out/moved" >>"$out/moves"
    "$here/measured.py" "$cluxel" --threads 1 retract "$map" "$last.pcd" >>"$out/retractions"
    mv "$out/extended.clx" "$map"
  done
  extend_s=$(median_of extensions 1) extend_mb=$(median_of extensions 3)
  python3 - "$out/report.json" "$millions" "$build_s" "$build_mb" "$extend_s" "$extend_mb" "$cut" \
    "$(median_of moves 1)" "$(median_of moves 3)" "$(median_of retractions 1)" "$(median_of retractions 3)" <<'PY'
import json, sys
report = json.load(open(sys.argv[1]))
build_s, extend_s, cut_s = float(sys.argv[3]), float(sys.argv[5]), float(sys.argv[7])
changed, tiles = report["tiles_changed"], report["tiles"]
print(f"| {sys.argv[2]} | {build_s:.2f} | {sys.argv[4]} | {extend_s:.2f} | {sys.argv[6]} | {changed} of {tiles} "
      f"| {extend_s / (build_s * changed / tiles):.2f} | {extend_s / cut_s:.2f} "
      f"| {float(sys.argv[8]) / cut_s:.2f} | {sys.argv[9]} | {float(sys.argv[10]) / cut_s:.2f} | {sys.argv[11]} |")
PY
  if [ "$millions" = "$1" ]; then
    "$cluxel" --threads 1 build "${inputs[@]}" "$out/last" -o "$out/all.clx" --force >/dev/null 2>&1
    cmp <("$cluxel" export "$map" --canonical 2>/dev/null) <("$cluxel" export "$out/all.clx" --canonical 2>/dev/null)
  fi
done
