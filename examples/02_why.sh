#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Why is it a tree? Needs the map of 01_build_and_ask.sh.
set -euo pipefail
cluxel=${CLUXEL:-build/release/cluxel} out=${1:-out/examples}
tree=$("$cluxel" query "$out/campus.clx" trees.rq --format csv | sed -n 2p | cut -d, -f1)
"$cluxel" explain "$out/campus.clx" "$tree"
