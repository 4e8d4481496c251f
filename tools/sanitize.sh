#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the tests under sanitizers: sanitize.sh [asan|tsan].
source "$(dirname "$0")/common.sh"

preset=${1:-asan}
install_base
install_clang
install_second_engine
build "$preset"
exec bash tools/run_tests.sh "$preset"
