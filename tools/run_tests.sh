#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the tests of a built preset and counts them: run_tests.sh PRESET [--require-data]. The last line is the count.
source "$(dirname "$0")/common.sh"

preset=${1:?PRESET} require_data=${2:-}
report="$PWD/build/$preset/reports/tests.xml"
rm -f "$report"
mkdir -p "$(dirname "$report")"

# Only what did not pass is shown, and a sign of life now and then. ctest keeps the rest in Testing/Temporary/LastTest.log.
show_what_matters() {
  local line
  while IFS= read -r line; do
    if [[ $line =~ ^\ *([0-9]+)/([0-9]+)\ Test ]] && [ $((BASH_REMATCH[1] % 200)) = 0 ]; then
      say "run: ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]} tests are done"
    fi
    [[ $line =~ ^\ +Start\ +[0-9]+:\  || $line =~ ^\ *[0-9]+/[0-9]+\ Test\ .*\ Passed\ +[0-9.]+\ sec$ ]] || say "$line"
  done
}

say "run: testing '$preset'"
status=0
ctest --preset "$preset" -j "$jobs" --output-junit "$report" \
  --test-output-size-passed 100000000 --test-output-size-failed 100000000 2>&1 | show_what_matters || status=$?
if [ ! -s "$report" ]; then
  say "run: ctest ended without a report"
  printf '0 passed, 1 failed, 0 skipped\n'
  exit 1
fi
awk -v require_data="$require_data" -f tools/count_tests.awk "$report" || status=$?
exit $((status != 0))
