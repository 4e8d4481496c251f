#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# page_test.sh SOURCE BUILD: maps of a small generated campus as pages, then tests in a browser. Skipped (77) where the
# page's program, Node or Chromium is absent.
set -euo pipefail
source_dir=$1 build_dir=$2
work=$build_dir/page_test cluxel=$build_dir/cluxel
readonly skipped=77

skip() { printf 'page_test: skipped: %s\n' "$*" >&2; exit "$skipped"; }

command -v node >/dev/null || skip "there is no node"
chromium=$(command -v chromium || command -v chromium-browser) || skip "there is no chromium"
[ -f "$source_dir/web/dist/page.html" ] || skip "web/dist/page.html is not there: ./run web"
[ -d "$source_dir/web/node_modules/playwright-core" ] || skip "playwright-core is not there: ./run web"

export CLUXEL_SOURCE=$source_dir CLUXEL_PROGRAM=$cluxel CLUXEL_PAGES=$work CLUXEL_CHROMIUM=$chromium CLUXEL_HOME=$source_dir
rm -rf "$work"
mkdir -p "$work"
cd "$work"
"$cluxel" simulate scans --stops 3 --size 60 --points-per-stop 40000 >/dev/null 2>&1
"$cluxel" build scans -o campus.clx 2>/dev/null
"$cluxel" view campus.clx -o campus.html

# The same scans with an ontology, a statement and a file name that try to be markup.
sed 's|"tree"@en|"</script><script>window.wasRun=1</script>"@en|' "$source_dir/ontology/outdoor.ttl" >markup.ttl
grep -q wasRun markup.ttl || { printf 'page_test: the label of trees was not found in the ontology\n' >&2; exit 1; }
"$cluxel" build scans -o '<b>markup.clx' --ontology "$source_dir/ontology/core.ttl" markup.ttl 2>/dev/null
tree=$("$cluxel" query '<b>markup.clx' trees.rq --format csv | sed -n 2p | cut -d, -f1)
"$cluxel" update '<b>markup.clx' -e "INSERT DATA { <$tree> <http://www.w3.org/2000/01/rdf-schema#label> \"\"\"<img src=x onerror=\"window.wasRun=1\">\"\"\" }" >/dev/null
# Numbers in forms that a map does not have otherwise, and one in its own.
"$cluxel" update '<b>markup.clx' -e 'INSERT DATA { <urn:thing> <https://example.org/size> 1.50, 5.0E-1 ; <https://example.org/length> 2.0 }' >/dev/null
"$cluxel" view '<b>markup.clx' -o markup.html

# Two visits, between which things change.
"$cluxel" simulate visits --visits 2 --stops 3 --size 60 --points-per-stop 40000 >/dev/null 2>&1
"$cluxel" build visits -o visits.clx 2>/dev/null
"$cluxel" view visits.clx -o visits.html

# A scan without a time, so no visit.
mkdir timeless
cp scans/scan_000.pcd timeless/
"$cluxel" build timeless -o timeless.clx 2>/dev/null
"$cluxel" view timeless.clx -o timeless.html

# A map that a change has touched.
cp campus.clx changed.clx
"$cluxel" retract changed.clx scan_002.pcd >/dev/null 2>&1
"$cluxel" view changed.clx -o changed.html

# The campus with classes of its own and a service, which may change it.
cat >own.ttl <<'END'
@prefix my: <https://example.org/town#> .
@prefix clx: <https://w3id.org/cluxel/ontology#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
my:StreetSign a owl:Class ; rdfs:subClassOf clx:StreetFurniture ; skos:prefLabel "town sign"@en .
my:LampA a owl:Class ; rdfs:subClassOf clx:StreetFurniture ; skos:prefLabel "double lamp"@en .
my:LampB a owl:Class ; rdfs:subClassOf clx:StreetFurniture ; skos:prefLabel "double lamp"@en .
clx:StreetLamp skos:prefLabel "Sokak Lambası"@tr .
END
"$cluxel" build scans -o served.clx --ontology "$source_dir/ontology/core.ttl" "$source_dir/ontology/outdoor.ttl" own.ttl 2>/dev/null
printf '0123456789abcdef0123\n' >token
"$cluxel" serve served.clx --port 0 --token-file token >url 2>access.log &
service=$!
trap 'kill "$service"' EXIT
# The same with a page that holds a tenth of the points.
"$cluxel" serve campus.clx --port 0 --page-points 12000 --quiet >sample.url &
sample_service=$!
# One that changes under its page.
cp campus.clx shrinking.clx
"$cluxel" serve shrinking.clx --port 0 --token-file token --quiet >changed.url &
changed_service=$!
trap 'kill "$service" "$sample_service" "$changed_service"' EXIT
until [ -s url ] || ! kill -0 "$service"; do sleep 0.1; done
until [ -s sample.url ] || ! kill -0 "$sample_service"; do sleep 0.1; done
until [ -s changed.url ] || ! kill -0 "$changed_service"; do sleep 0.1; done
CLUXEL_SERVICE=$(cat url) CLUXEL_SAMPLE_SERVICE=$(cat sample.url) CLUXEL_CHANGED_SERVICE=$(cat changed.url)
export CLUXEL_SERVICE CLUXEL_SAMPLE_SERVICE CLUXEL_CHANGED_SERVICE
for file in "$source_dir"/tests/web/*_test.mjs; do node --test "$file"; done
