#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Scores `cluxel changes` on generated campuses with two visits, or VISITS: what the last visit changed.
# LATER_STOPS=1 lets the later visits see little, to count what is called gone without being observed.
# Usage: [LATER_STOPS=N] [VISITS=N] bench/changes.sh CLUXEL OUT SEED...
set -euo pipefail
[ $# -ge 3 ] || { sed -n '5s/^# //p' "$0" >&2; exit 2; }
cluxel=$1 out=$2 visits=${VISITS:-2}
shift 2
mkdir -p "$out"
for seed in "$@"; do
  scans=$out/$seed
  [ -d "$scans" ] || "$cluxel" simulate "$scans" --seed "$seed" --visits "$visits" --pose-error 0.05 \
    --later-stops "${LATER_STOPS:-0}" >/dev/null 2>&1
  "$cluxel" build "$scans" -o "$out/$seed.clx" --force >/dev/null 2>&1
  points=()
  [ "$visits" -ne 2 ] || points=(--points "$out/$seed.points.csv") # the truth of points is of two visits
  "$cluxel" changes "$out/$seed.clx" --json "${points[@]}" >"$out/$seed.json" 2>/dev/null || true
  python3 "$(dirname "$0")/change_scores.py" "$out/$seed.json" "$scans/truth" "${points[@]}" >"$out/$seed.scores"
done
python3 "$(dirname "$0")/change_scores.py" --sum "$out"/*.scores
