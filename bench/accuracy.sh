#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The figures of docs/accuracy.md: leave two chunks out on Oakland part 2, and unseen seeds of the generated campus.
# Usage: bench/accuracy.sh CLUXEL DATA OUT [train|measure]   (DATA holds oakland3d and oakland3d_truth)
set -euo pipefail
cluxel=$1 data=$2 out=$3 what=${4:-all}
folds=("ac ad" "ae ag" "ah ai" "aj ak" "al ao")
mkdir -p "$out"

# What the shipped model learns from beside the chunks (models/oakland/README.md).
helpers=()
for seed in 11 12 13 14; do
  [ -d "$out/campus$seed" ] || "$cluxel" simulate "$out/campus$seed" --seed "$seed" --stops 4 --size 60 >/dev/null
  helpers+=(--helper "$out/campus$seed")
done

chunks() { for name in "$@"; do printf '%s\n' "$data/oakland3d/oakland_part2_$name.xyz_label_conf"; done; }

for i in "${!folds[@]}"; do
  held=${folds[$i]}
  rest=()
  for j in "${!folds[@]}"; do [ "$j" = "$i" ] || rest+=(${folds[$j]}); done
  # The fold's model has seen neither of the two chunks, nor have its calibration and pairwise term.
  if [ "$what" != measure ]; then
    "$cluxel" train $(chunks "${rest[@]}") --truth "$data/oakland3d_truth" "${helpers[@]}" --helper-truth campus.yaml \
      -o "$out/fold$i" >"$out/fold$i.train.txt"
  fi
  if [ "$what" != train ]; then
    "$cluxel" build $(chunks $held) -o "$out/fold$i.clx" --model "$out/fold$i" --force >"$out/fold$i.build.txt"
    "$cluxel" evaluate "$out/fold$i.clx" --truth "$data/oakland3d_truth" --json >"$out/fold$i.json"
  fi
done
[ "$what" = train ] && exit 0

# Seeds that no model was trained on and no rule was chosen on.
for seed in 901 902 903; do
  [ -d "$out/campus$seed" ] || "$cluxel" simulate "$out/campus$seed" --seed "$seed" >/dev/null
  for model in oakland campus; do
    "$cluxel" build "$out/campus$seed" -o "$out/campus$seed.$model.clx" --model "$model" --force >/dev/null
    "$cluxel" evaluate "$out/campus$seed.$model.clx" --truth "$out/campus$seed/truth" --json >"$out/campus$seed.$model.json"
  done
done
