#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# demo_map.sh CLUXEL FOLDER: maps a generated campus into FOLDER, asks it questions, and exports what the README speaks of.
set -euo pipefail
cluxel=$1 out=$2

say() { printf '%s\n' "$*" >&2; }

rm -rf "$out"
mkdir -p "$out"
say "run: generating the scans of a campus"
"$cluxel" simulate "$out/scans" --seed 7
say "run: building a map of the first six scans"
mkdir "$out/first"
ln -s ../scans/scan_00{0..5}.pcd "$out/first/"
grep -v '^#' "$out/scans/poses.txt" | head -6 >"$out/first/poses.txt"
head -6 "$out/scans/times.txt" >"$out/first/times.txt"
"$cluxel" build "$out/first" -o "$out/campus.clx"
say "run: extending it by the others; what changes, with some of the objects that came, changed, split and joined:"
"$cluxel" extend "$out/campus.clx" "$out/scans" --list 3
say "run: asking it where the street signs are: street_signs.rq"
"$cluxel" query "$out/campus.clx" street_signs.rq
sign=$("$cluxel" query "$out/campus.clx" street_signs.rq --format csv | sed -n '2s/,.*//p')
say "run: why is the first of them a street sign?"
"$cluxel" explain "$out/campus.clx" "$sign"
say "run: where should I look for street signs first?"
"$cluxel" ask "$out/campus.clx" search for=StreetSign stops=5 --why
say "run: a cost map without vehicles, and the objects for maps of other programs"
"$cluxel" costmap "$out/campus.clx" --without Vehicle -o "$out/campus.pgm"
"$cluxel" export "$out/campus.clx" --local -o "$out/campus.geojson"
if command -v ogrinfo >/dev/null; then ogrinfo -so -al "$out/campus.geojson" | grep -E '^(Layer name|Geometry|Feature Count)'; fi
"$cluxel" export "$out/campus.clx" -o "$out/campus.ply"
