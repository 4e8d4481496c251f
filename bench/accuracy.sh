#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The figures of docs/accuracy.md: places and sensors that training did not see. Evaluations go to OUT/PART/*.json, maps
# and models stay beside them; bench/accuracy_tables.py OUT makes the tables. A model that is there is not trained again.
# Usage: bench/accuracy.sh CLUXEL DATA OUT [PART...]
#   DATA holds oakland3d, oakland3d_truth, sydney, nuscenes, kitti00. Parts, all of them when none is named:
#   folds     Oakland by pairs of chunks: five models trained without them
#   halves    Oakland by place: trained on ac to ah, judged on ai to ao, and the other way
#   sydney, nuscenes, kitti   each scan a map of its own; the shipped models, which saw none of them
#   sydney_halves   Sydney again, with the other half of its scans in training
#   campus    generated campuses that no model was trained on and no rule was chosen on
#   stops     the paper's experiment on a generated campus: 77 stop-and-go scans
# THREADS (default 1) is the number of threads.
set -euo pipefail
here=$(dirname "$(realpath "$0")")
[ $# -ge 3 ] || { sed -n '5,14s/^# //p' "$0" >&2; exit 2; }
program=$1 data=$2 out=$3
shift 3
[ $# -gt 0 ] || set -- folds halves sydney nuscenes kitti sydney_halves campus stops
chunks=(ac ad ae ag ah ai aj ak al ao)
models=(oakland campus)

cluxel() { "$program" --threads "${THREADS:-1}" "$@"; }
files_of() { for name in "$@"; do printf '%s\n' "$data/oakland3d/oakland_part2_$name.xyz_label_conf"; done; }

# What the shipped model learns from beside the chunks (models/oakland/README.md).
make_helpers() {
  helpers=()
  for seed in 11 12 13 14; do
    local folder=$out/helpers/campus$seed
    [ -d "$folder" ] || cluxel simulate "$folder" --seed "$seed" --stops 4 --size 60 >/dev/null
    helpers+=(--helper "$folder")
  done
}

# train NAME HELD...: a model from all chunks but HELD. Points within 10 m of a held chunk, and objects that cross its
# border, are left out; so neither unary, pairwise term nor calibration has seen the held place.
train() {
  local name=$1 held=" ${*:2} " rest=()
  local folder=$out/oakland/$name
  [ ! -f "$folder/model.json" ] || return 0
  for chunk in "${chunks[@]}"; do [[ $held == *" $chunk "* ]] || rest+=("$chunk"); done
  "$here/leave_out_border.py" "$data" "$folder.truth" "${@:2}" >"$folder.border.txt"
  make_helpers
  cluxel train $(files_of "${rest[@]}") --truth "$folder.truth" "${helpers[@]}" --helper-truth campus.yaml \
    -o "$folder" >"$folder.train.txt"
}

# judge NAME HELD...: the held chunks as one map, labelled by the model NAME.
judge() {
  local name=$out/oakland/$1
  cluxel build $(files_of "${@:2}") -o "$name.clx" --model "$name" --force >/dev/null
  cluxel evaluate "$name.clx" --truth "$data/oakland3d_truth" --json >"$name.json"
}

place_out() {
  mkdir -p "$out/oakland"
  train "$@"
  judge "$@"
}

# scans PART TRUTH SCAN...: every scan a map of its own, with each shipped model.
scans() {
  local part=$1 truth=$2 model scan
  for model in "${models[@]}"; do
    mkdir -p "$out/$part/$model"
    for scan in "${@:3}"; do
      cluxel build "$scan" -o "$out/$part/$model/$(basename "$scan" .ply).clx" --model "$model" --force >/dev/null
    done
    cluxel evaluate "$out/$part/$model"/*.clx --truth "$truth" --json >"$out/$part/$model.json"
  done
}

# Every second scan of Sydney trains a model beside Oakland and the generated campuses; the others are judged by it.
sydney_halves() {
  local half scan i held names=(even odd)
  make_helpers
  mkdir -p "$out/sydney_halves"
  for half in 0 1; do
    local model=$out/sydney_halves/${names[$half]} helping=("${helpers[@]}") truths=()
    for i in 1 2 3 4; do truths+=(--helper-truth campus.yaml); done
    held=() i=0
    for scan in "$data"/sydney/*.ply; do
      if [ $((i % 2)) = "$half" ]; then helping+=(--helper "$scan") truths+=(--helper-truth sydney.yaml); else held+=("$scan"); fi
      i=$((i + 1))
    done
    [ -f "$model/model.json" ] || cluxel train $(files_of "${chunks[@]}") --truth "$data/oakland3d_truth" \
      "${helping[@]}" "${truths[@]}" -o "$model" >"$model.train.txt"
    mkdir -p "$model.maps"
    for scan in "${held[@]}"; do
      cluxel build "$scan" -o "$model.maps/$(basename "$scan" .ply).clx" --model "$model" --force >/dev/null
    done
    cluxel evaluate "$model.maps"/*.clx --truth sydney --json >"$out/sydney_halves/${names[$half]}.json"
  done
}

# A frame with its labels but without its pose, as a folder in KITTI's layout.
kitti_frames() {
  local scan frame
  for scan in "$data"/kitti00/velodyne/*.bin; do
    frame=$(basename "$scan" .bin)
    mkdir -p "$out/kitti/frames/$frame"/{velodyne,labels}
    cp -f "$scan" "$out/kitti/frames/$frame/velodyne/"
    cp -f "$data/kitti00/labels/$frame.label" "$out/kitti/frames/$frame/labels/"
  done
}

campuses() {
  local seed model folder
  mkdir -p "$out/campus"
  for seed in 901 902 903; do
    folder=$out/campus/$seed
    [ -d "$folder" ] || cluxel simulate "$folder" --seed "$seed" >/dev/null
    for model in "${models[@]}"; do
      cluxel build "$folder" -o "$folder.$model.clx" --model "$model" --force >/dev/null
      cluxel evaluate "$folder.$model.clx" --truth "$folder/truth" --json >"$folder.$model.json"
    done
  done
}

many_stops() {
  local folder=$out/stops/904
  mkdir -p "$out/stops"
  [ -d "$folder" ] || cluxel simulate "$folder" --seed 904 --stops 77 --size 369 >/dev/null
  cluxel build "$folder" -o "$folder.clx" --model campus --force >/dev/null
  cluxel evaluate "$folder.clx" --truth "$folder/truth" --json >"$out/stops/campus.json"
}

for part in "$@"; do
  case $part in
    folds)
      place_out fold0 ac ad
      place_out fold1 ae ag
      place_out fold2 ah ai
      place_out fold3 aj ak
      place_out fold4 al ao
      ;;
    halves)
      place_out half_ac_ah ai aj ak al ao
      place_out half_ai_ao ac ad ae ag ah
      ;;
    sydney | nuscenes) scans "$part" "$part" "$data/$part"/*.ply ;;
    kitti)
      kitti_frames
      scans kitti semantickitti "$out"/kitti/frames/*
      ;;
    sydney_halves) sydney_halves ;;
    campus) campuses ;;
    stops) many_stops ;;
    *)
      echo "accuracy.sh: no part '$part': the parts are folds, halves, sydney, nuscenes, kitti, sydney_halves, campus, stops" >&2
      exit 2
      ;;
  esac
done
