#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Takes the pictures of the page into docs/images: of the generated campus, of two visits to one, and of two real scans where
# ../shared/data/small_gicp holds them. Needs Chromium and ./run web.
source "$(dirname "$0")/common.sh"

install_packages chromium
install_web_tools
build_web
build release cluxel
cluxel=build/release/cluxel work=$PWD/out/pictures real=${CLUXEL_DATA:-../shared/data}/small_gicp
mkdir -p "$work"
[ -f "$work/campus.clx" ] || { "$cluxel" simulate "$work/scans" --seed 7 && "$cluxel" build "$work/scans" -o "$work/campus.clx"; }
"$cluxel" view "$work/campus.clx" -o "$work/campus.html"
node tools/page_pictures.mjs "$work/campus.html" docs/images/page_campus.jpg street_signs.rq 1 dark home
[ -f "$work/visits.clx" ] || {
  "$cluxel" simulate "$work/visits" --visits 2 --stops 3 --size 60 --points-per-stop 40000 &&
    "$cluxel" build "$work/visits" -o "$work/visits.clx"
}
"$cluxel" view "$work/visits.clx" -o "$work/visits.html"
node tools/page_pictures.mjs "$work/visits.html" docs/images/page_visits.jpg visits
[ -f "$real/T_target_source.txt" ] || exit 0
if [ ! -f "$work/real.clx" ]; then   # two scans, the first posed in the frame of the second
  mkdir -p "$work/real"
  cp "$real"/{source,target}.ply "$work/real/"
  { cat "$real/T_target_source.txt"; printf '\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n'; } >"$work/real/poses.txt"
  "$cluxel" build "$work/real" -o "$work/real.clx"
fi
"$cluxel" view "$work/real.clx" -o "$work/real.html"
node tools/page_pictures.mjs "$work/real.html" docs/images/page_real.jpg
