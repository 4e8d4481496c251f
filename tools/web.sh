#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the page's program, web/dist/page.html, which `cluxel view` needs.
source "$(dirname "$0")/common.sh"

install_web_tools
build_web --again
