#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds everything and runs every test: test.sh [--long] [--require-data].
source "$(dirname "$0")/common.sh"

options=()
for option in "$@"; do
  case "$option" in
    --long) export CLUXEL_LONG_TESTS=1 ;;
    --require-data) options+=("$option") ;;
    *) die "unknown option '$option' of ./run test" 2 ;;
  esac
done
install_base
install_packages dpkg-dev file lintian   # for the test of the packages
install_second_engine
install_endpoint_client
make_page
install_packages chromium   # the tests of the page
build release
exec bash tools/run_tests.sh release "${options[@]}"
