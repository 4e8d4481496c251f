#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# first_visit_test.sh SOURCE BUILD: does what `./run demo` does, then on its page what the README tells a newcomer to do.
# Skipped (77) where the page's program, Node or Chromium is absent.
set -euo pipefail
source_dir=$1 build_dir=$2
work=$build_dir/first_visit_test cluxel=$build_dir/cluxel
readonly skipped=77

skip() { printf 'first_visit_test: skipped: %s\n' "$*" >&2; exit "$skipped"; }
fail() { printf 'first_visit_test: %s\n' "$*" >&2; exit 1; }

command -v node >/dev/null || skip "there is no node"
chromium=$(command -v chromium || command -v chromium-browser) || skip "there is no chromium"
[ -f "$source_dir/web/dist/page.html" ] || skip "web/dist/page.html is not there: ./run web"
[ -d "$source_dir/web/node_modules/playwright-core" ] || skip "playwright-core is not there: ./run web"

export CLUXEL_SOURCE=$source_dir CLUXEL_PROGRAM=$cluxel CLUXEL_PAGES=$work CLUXEL_CHROMIUM=$chromium CLUXEL_HOME=$source_dir
bash "$source_dir/tools/demo_map.sh" "$cluxel" "$work" >"$build_dir/first_visit.log" 2>&1 || fail "the demo failed: $build_dir/first_visit.log"
log=$build_dir/first_visit.log hash='[0-9a-f]{32}'
# told KIND LINE: below the count of a kind of change, the demo lists objects as LINE says.
told() {
  sed -n "/^  [0-9]* $1/,/^  [0-9]/p" "$log" | grep -Eq "^    [A-Za-z]+ $hash$2\$" || fail "the demo lists no object that is '$1'"
}
told added ''
told changed ", was [A-Za-z]+ $hash"
told 'from splits' ", was [A-Za-z]+ $hash"
told joined ", was [A-Za-z]+ $hash, [A-Za-z]+ $hash.*"
head -c 3 "$work/campus.pgm" | grep -q P5 || fail "campus.pgm is no image"
objects=$("$cluxel" info "$work/campus.clx" --json | node -p 'JSON.parse(require("node:fs").readFileSync(0)).objects')
grep -q 'campus' "$work/campus.yaml" || fail "campus.yaml does not name its image"
if command -v ogrinfo >/dev/null; then
  ogrinfo -so -al "$work/campus.geojson" | grep "^Feature Count: $objects$" >/dev/null || fail "ogrinfo does not find $objects objects"
else
  printf 'first_visit_test: ogrinfo is not there (Debian: gdal-bin); the export is read by node alone\n' >&2
  node -e 'const { features } = JSON.parse(require("node:fs").readFileSync(process.argv[1]));
           if (features.length !== Number(process.argv[2])) process.exit(1);' "$work/campus.geojson" "$objects" ||
    fail "campus.geojson does not hold $objects objects"
fi

printf '0123456789abcdef0123\n' >"$work/token"
"$cluxel" serve "$work/campus.clx" --port 0 --token-file "$work/token" >"$work/url" 2>"$work/access.log" &
service=$!
trap 'kill "$service"' EXIT
until [ -s "$work/url" ] || ! kill -0 "$service"; do sleep 0.1; done
CLUXEL_SERVICE=$(cat "$work/url")
export CLUXEL_SERVICE
node --test "$source_dir/tests/web/first_visit.mjs"
