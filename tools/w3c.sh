#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the W3C SPARQL suites and prints a table per group: w3c.sh [FOLDER] [--only TEXT].
source "$(dirname "$0")/common.sh"

install_base
build release w3c_runner
exec build/release/tests/sparql/w3c_runner "$@"
