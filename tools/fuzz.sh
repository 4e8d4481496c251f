#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every fuzz target, or those whose name holds NAME, for SECONDS each: fuzz.sh [SECONDS] [NAME].
source "$(dirname "$0")/common.sh"

seconds=${1:-60} name_filter=${2:-}
export LSAN_OPTIONS="suppressions=$PWD/tests/leaks.supp:print_suppressions=0" UBSAN_OPTIONS="print_stacktrace=1"

start_inputs() {  # start_inputs TARGET
  case "$1" in
    rules_*) echo rules ;;
  esac
  [ ! -d "tests/fuzz/seeds/$1" ] || echo "tests/fuzz/seeds/$1"
}

install_base
install_clang
build asan fuzz_targets
for program in build/asan/tests/fuzz/*_fuzz; do
  target=$(basename "$program")
  case "$target" in *"$name_filter"*) ;; *) continue ;; esac
  say "run: $target for $seconds s"
  mkdir -p "out/fuzz/$target"
  mapfile -t seeds < <(start_inputs "$target")
  "$program" -max_total_time="$seconds" -rss_limit_mb=4096 -timeout=25 -verbosity=0 -print_final_stats=0 \
    -artifact_prefix="out/fuzz/" "out/fuzz/$target" "${seeds[@]}" >&2 || die "$target found a fault: see out/fuzz"
done
say "run: no finding"
