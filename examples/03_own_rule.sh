#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Another notion of a thing: the shipped rules with one constant changed, checked, and applied. Needs the scans of 01_build_and_ask.sh.
set -euo pipefail
cluxel=${CLUXEL:-build/release/cluxel} out=${1:-out/examples}
sed 's/trunk_max_width: 1.40 m/trunk_max_width: 0.30 m/' rules/outdoor.rules.yaml > "$out/thin_trunks.rules.yaml"
"$cluxel" rules check "$out/thin_trunks.rules.yaml"
"$cluxel" build "$out/scans" -o "$out/thin_trunks.clx" --rules "$out/thin_trunks.rules.yaml" --force
"$cluxel" info "$out/campus.clx"
"$cluxel" info "$out/thin_trunks.clx"
