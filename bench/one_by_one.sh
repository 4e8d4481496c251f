#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Scans committed one by one against one batch, and against what the tiles that each commit changes cost from scratch.
# Usage: bench/one_by_one.sh CLUXEL OUT [SCANS [EVERY]]: SCANS on a campus of 250 m (48)
# The cost from scratch is the build of a map from the points of the changed tiles (bench/cut_tiles.py). It is measured
# for every EVERY-th commit (6), in the middle of its stretch, and multiplied. One batch is `build`; one by one is
# `build --batch-points 1`. The aim is 1.3 times the sum.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '4s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 count=${3:-48} every=${4:-6} here=$(dirname "$0")
mkdir -p "$out"
scans=$out/scans_$count
[ -d "$scans" ] || "$cluxel" simulate "$scans" --seed 31 --stops "$count" --size 250 >/dev/null 2>&1

seconds() { "$here/measured.py" "$@" | cut -d' ' -f1; }
files=("$scans"/scan_*.pcd)
batch=$(seconds "$cluxel" --threads 1 build "$scans" -o "$out/batch.clx" --force)
single=$(seconds "$cluxel" --threads 1 build "$scans" -o "$out/single.clx" --force --batch-points 1)
cmp <("$cluxel" export "$out/single.clx" --canonical 2>/dev/null) <("$cluxel" export "$out/batch.clx" --canonical 2>/dev/null)
sum=0
for ((i = every / 2; i < count; i += every)); do
  rm -rf "$out/cut"
  "$here/cut_tiles.py" "$out/cut" "${files[i]}" "${files[@]:0:i+1}" >/dev/null
  cut=$(seconds "$cluxel" --threads 1 build "$out/cut" -o "$out/cut.clx" --force)
  sum=$(awk -v a="$sum" -v b="$cut" -v n="$every" 'BEGIN { print a + b * n }')
done
awk -v b="$batch" -v s="$single" -v c="$sum" 'BEGIN {
  print "| one batch [s] | one by one [s] | of one batch | sum of the changed tiles from scratch [s] | of this sum |\n|---|---|---|---|---|"
  printf "| %.2f | %.2f | %.2f | %.2f | %.2f |\n", b, s, s / b, c, s / c }'
