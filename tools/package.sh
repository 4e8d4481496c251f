#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# makes the Debian packages in build/packages and checks them with lintian
source "$(dirname "$0")/common.sh"

packages="$PWD/build/packages"
install_base
install_packages dpkg-dev file lintian
say "run: configuring 'release' with Debian's folders"
configure release -DCMAKE_INSTALL_LIBDIR="lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)" -DCLUXEL_PYTHON=ON
build release cluxel cluxel_library librdf_storage_cluxel cluxel_python cluxel_documentation
rm -rf "$packages"
mkdir -p "$packages"
(cd build/release && umask 022 && cpack -G DEB -B "$packages" >"$packages/cpack.log" 2>&1) ||
  { cat "$packages/cpack.log" >&2; die "cpack failed"; }
rm -rf "$packages/_CPack_Packages"
say "run: checking the packages"
# The packages are not uploaded to Debian: no report there asks for them.
lintian --allow-root --fail-on error --tag-display-limit 0 --suppress-tags initial-upload-closes-no-bugs "$packages"/*.deb >&2 ||
  die "lintian found errors in the packages of $packages"
printf '%s\n' "$packages"/*.deb
