#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From scans to an answer: a small generated campus, its map, two questions.
set -euo pipefail
cluxel=${CLUXEL:-build/release/cluxel} out=${1:-out/examples}
mkdir -p "$out"
[ -d "$out/scans" ] || "$cluxel" simulate "$out/scans" --seed 1 --stops 4 --size 50 --points-per-stop 40000
"$cluxel" build "$out/scans" -o "$out/campus.clx" --force
"$cluxel" query "$out/campus.clx" count_by_class.rq
"$cluxel" query "$out/campus.clx" near_point.rq --param x=0 --param y=0 --param radius=6
