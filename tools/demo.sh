#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the program, maps a generated campus and asks the map a question.
source "$(dirname "$0")/common.sh"

install_base
build release cluxel
cluxel=build/release/cluxel out=out/demo
rm -rf "$out"
mkdir -p "$out"
say "run: generating the scans of a campus"
"$cluxel" simulate "$out/scans" --seed 7
say "run: building the map"
"$cluxel" build "$out/scans" -o "$out/campus.clx" --force
say "run: asking it: queries/street_signs.rq"
"$cluxel" query "$out/campus.clx" queries/street_signs.rq
"$cluxel" export "$out/campus.clx" -o "$out/campus.ply"
say ""
say "The map is $out/campus.clx; its points coloured by class are in $out/campus.ply (any point cloud viewer shows it)."
say "More questions: $cluxel tasks      Why is it that?  $cluxel explain $out/campus.clx <object>"
