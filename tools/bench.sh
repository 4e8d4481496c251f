#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds and runs the benchmarks, or those whose name holds NAME: bench.sh [NAME].
source "$(dirname "$0")/common.sh"

install_base
install_second_engine
names=()
for source in bench/*_bench.cpp; do
  name=$(basename "$source" .cpp)
  case "$name" in *"${1:-}"*) names+=("$name") ;; esac
done
[ "${#names[@]}" != 0 ] || die "no benchmark is called '$1'" 2
build bench "${names[@]}"
for name in "${names[@]}"; do
  say "run: $name"
  "build/bench/bench/$name"
done
