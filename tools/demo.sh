#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the program, maps a generated campus and asks the map a question.
source "$(dirname "$0")/common.sh"

install_base
build release cluxel
make_page
cluxel=build/release/cluxel out=out/demo
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
say "run: extending it by the others; what changes:"
"$cluxel" extend "$out/campus.clx" "$out/scans"
say "run: asking it: queries/street_signs.rq"
"$cluxel" query "$out/campus.clx" queries/street_signs.rq
sign=$("$cluxel" query "$out/campus.clx" queries/street_signs.rq --format csv | sed -n '2s/,.*//p')
say "run: why is the first of them a street sign?"
"$cluxel" explain "$out/campus.clx" "$sign"
say "run: where should I look for street signs first?"
"$cluxel" ask "$out/campus.clx" search for=StreetSign stops=5 --why
say "run: a cost map without vehicles, and the objects for maps of other programs"
"$cluxel" costmap "$out/campus.clx" --without Vehicle -o "$out/campus.pgm"
"$cluxel" export "$out/campus.clx" --local -o "$out/campus.geojson"
if command -v ogrinfo >/dev/null; then ogrinfo -so -al "$out/campus.geojson" | grep -E '^(Layer name|Geometry|Feature Count)'; fi
"$cluxel" export "$out/campus.clx" -o "$out/campus.ply"
if [ -f web/dist/page.html ]; then
  "$cluxel" view "$out/campus.clx" -o "$out/campus.html"
  say ""
  say "Open $PWD/$out/campus.html in a browser: look around, ask, click on things, see why they are what they are."
fi
say ""
say "The map is $out/campus.clx; its points coloured by class are in $out/campus.ply (any point cloud viewer shows it)."
say "The cost map is $out/campus.pgm with campus.yaml, the objects are in $out/campus.geojson."
say "More questions: $cluxel tasks      Why is it that?  $cluxel explain $out/campus.clx <object>"
