#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Judges fitted rules on places and sensors that the fit left out: for each target in turn, fits the evidence to the maps
# of all others, applies the rules to the target's maps, and evaluates. bench/accuracy_tables.py OUT makes the tables.
# Usage: bench/fit_left_out.sh CLUXEL DATA MAPS RULES OUT
#   MAPS is a folder that bench/accuracy.sh filled (parts halves, sydney, nuscenes, kitti, and folds if they are to be
#   judged, too); its maps are changed.
#   RULES is the rule file before the fit: what bench/unfitted_rules.py writes.
set -euo pipefail
[ $# -eq 5 ] || { sed -n '5,8s/^# //p' "$0" >&2; exit 2; }
program=$1 data=$2 maps=$3 rules=$4 out=$5
oakland=$data/oakland3d_truth
# No truth tells these apart, or has a lamp on a pole of its own.
keep=(--keep ground/patches --keep barrier/fence --keep barrier/run --keep bush/solid-leaves --keep street_lamp/pole)
mkdir -p "$out"/{oakland,sydney,nuscenes,kitti}

# fit TARGET FIT-ARGUMENT...
fit() { "$program" rules fit "${@:2}" "${keep[@]}" --rules "$rules" -o "$out/$1.yaml" >"$out/$1.fit.txt"; }

# judge TARGET TRUTH RESULT MAP...
judge() {
  local map
  for map in "${@:4}"; do "$program" rules apply "$map" --rules "$out/$1.yaml" >/dev/null; done
  "$program" evaluate "${@:4}" --truth "$2" --json >"$3"
}

sydney=(--also "sydney=$maps/sydney/oakland") nuscenes=(--also "nuscenes=$maps/nuscenes/oakland")
kitti=(--also "semantickitti=$maps/kitti/oakland")
first=$maps/oakland/half_ac_ah.clx second=$maps/oakland/half_ai_ao.clx   # named for the model; each shows the other half

fit half_ac_ah "$second" --truth "$oakland" "${sydney[@]}" "${nuscenes[@]}" "${kitti[@]}"
fit half_ai_ao "$first" --truth "$oakland" "${sydney[@]}" "${nuscenes[@]}" "${kitti[@]}"
fit sydney "$first" "$second" --truth "$oakland" "${nuscenes[@]}" "${kitti[@]}"
fit nuscenes "$first" "$second" --truth "$oakland" "${sydney[@]}" "${kitti[@]}"
fit kitti "$first" "$second" --truth "$oakland" "${sydney[@]}" "${nuscenes[@]}"

judge half_ac_ah "$oakland" "$out/oakland/half_ac_ah.json" "$first"
judge half_ai_ao "$oakland" "$out/oakland/half_ai_ao.json" "$second"
judge sydney sydney "$out/sydney/oakland.json" "$maps"/sydney/oakland/*.clx
judge nuscenes nuscenes "$out/nuscenes/oakland.json" "$maps"/nuscenes/oakland/*.clx
judge kitti semantickitti "$out/kitti/oakland.json" "$maps"/kitti/oakland/*.clx

# The folds: each with rules from the other folds and the other sensors.
folds=("$maps"/oakland/fold?.clx)
if [ -e "${folds[0]}" ]; then
  for fold in "${folds[@]}"; do
    name=$(basename "$fold" .clx) others=()
    for other in "${folds[@]}"; do [ "$other" = "$fold" ] || others+=("$other"); done
    fit "$name" "${others[@]}" --truth "$oakland" "${sydney[@]}" "${nuscenes[@]}" "${kitti[@]}"
  done
  for fold in "${folds[@]}"; do
    judge "$(basename "$fold" .clx)" "$oakland" "$out/oakland/$(basename "$fold" .clx).json" "$fold"
  done
fi
