#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the program, maps a generated campus, asks the map questions, and shows its page.
source "$(dirname "$0")/common.sh"

install_base
build release cluxel
make_page
cluxel=build/release/cluxel out=out/demo
bash tools/demo_map.sh "$cluxel" "$out"
say ""
say "The map is $out/campus.clx; its points coloured by class are in $out/campus.ply (any point cloud viewer shows it)."
say "The cost map without vehicles is $out/campus.pgm with campus.yaml, the objects are in $out/campus.geojson."
say "More questions: $cluxel tasks      Why is it that?  $cluxel explain $out/campus.clx <object>"
[ -f web/dist/page.html ] || exit 0

"$cluxel" view "$out/campus.clx" -o "$out/campus.html"
(umask 077 && head -c 24 /dev/urandom | base64 | tr -dc 'A-Za-z0-9' >"$out/token")
serve=("$cluxel" serve "$out/campus.clx" --token-file "$out/token" --log "$out/access.log")
say ""
say "As one file without a server: $PWD/$out/campus.html"
if [ ! -t 1 ]; then
  say "With all tasks: ${serve[*]}"
  say "Open http://127.0.0.1:8080/page then."
  exit 0
fi
"${serve[@]}" --port 0 >"$out/url" &
service=$!
trap 'kill "$service" 2>/dev/null' EXIT
until [ -s "$out/url" ] || ! kill -0 "$service"; do sleep 0.1; done
say "Open $(cat "$out/url")page in a browser: look around, ask, click on things, see why they are what they are."
say "To try changed rules on the page, its token is $(cat "$out/token")"
say "Ctrl C ends it."
wait "$service"
