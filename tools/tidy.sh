#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy on the sources whose path holds NAME, or on all, by the Clang preset's compile commands: tidy.sh [NAME].
source "$(dirname "$0")/common.sh"

install_base
install_packages clang clang-tidy
configure asan
mapfile -t sources < <(find src -name '*.cpp' | sort | grep -- "${1:-}")
[ "${#sources[@]}" != 0 ] || die "no source's path holds '$1'" 2
printf '%s\n' "${sources[@]}" | xargs -P "$jobs" -n 1 clang-tidy --quiet -p build/asan 2>/dev/null ||
  die "clang-tidy has findings"
say "run: no finding"
