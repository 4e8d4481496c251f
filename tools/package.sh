#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# makes the Debian packages in build/packages and checks them with lintian
source "$(dirname "$0")/common.sh"

install_base
install_packages dpkg-dev file lintian
install_web_tools
build_web
configure release -DCMAKE_INSTALL_LIBDIR="lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)" -DCLUXEL_PYTHON=ON
build release cluxel cluxel_library librdf_storage_cluxel cluxel_python cluxel_documentation
bash tools/make_packages.sh build/release "$PWD/build/packages"
printf '%s\n' build/packages/*.deb
