#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A map is a function of its inputs: threads and batches do not show. Needs the scans of 01_build_and_ask.sh.
set -euo pipefail
cluxel=${CLUXEL:-build/release/cluxel} out=${1:-out/examples}
"$cluxel" build "$out/scans" -o "$out/a.clx" --threads 1 --force
"$cluxel" build "$out/scans" -o "$out/b.clx" --threads 2 --batch-points 50000 --force
"$cluxel" export "$out/a.clx" --canonical > "$out/a.nq"
"$cluxel" export "$out/b.clx" --canonical > "$out/b.nq"
cmp "$out/a.nq" "$out/b.nq" && echo "the same map"
