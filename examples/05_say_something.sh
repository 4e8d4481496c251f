#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A person's statement about an object goes into the graph "operator". Needs the map of 01_build_and_ask.sh.
set -euo pipefail
cluxel=${CLUXEL:-build/release/cluxel} out=${1:-out/examples}
tree=$("$cluxel" query "$out/campus.clx" trees.rq --format csv | sed -n 2p | cut -d, -f1)
"$cluxel" update "$out/campus.clx" -e "INSERT DATA { <$tree> <http://www.w3.org/2000/01/rdf-schema#label> \"the old one by the gate\"@en }"
"$cluxel" query "$out/campus.clx" -e "SELECT ?label { <$tree> <http://www.w3.org/2000/01/rdf-schema#label> ?label }"
