#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Scores `cluxel changes` on generated campuses with two visits.
# LATER_STOPS=1 lets the second visit see little, to count what is called gone without being observed.
# Usage: [LATER_STOPS=N] bench/changes.sh CLUXEL OUT SEED...
set -euo pipefail
[ $# -ge 3 ] || { sed -n '5s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2
shift 2
mkdir -p "$out"
for seed in "$@"; do
  scans=$out/$seed
  [ -d "$scans" ] || "$cluxel" simulate "$scans" --seed "$seed" --visits 2 --pose-error 0.05 \
    --later-stops "${LATER_STOPS:-0}" >/dev/null 2>&1
  "$cluxel" build "$scans" -o "$out/$seed.clx" --force >/dev/null 2>&1
  "$cluxel" changes "$out/$seed.clx" --json --points "$out/$seed.points.csv" >"$out/$seed.json" 2>/dev/null || true
  python3 "$(dirname "$0")/change_scores.py" "$out/$seed.json" "$scans/truth" --points "$out/$seed.points.csv" \
    >"$out/$seed.scores"
done
python3 "$(dirname "$0")/change_scores.py" --sum "$out"/*.scores
