#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# make_packages.sh BUILD FOLDER: packs a finished build into Debian packages in FOLDER, and checks them with lintian where
# that is installed. Builds nothing.
source "$(dirname "$0")/common.sh"

build_dir=${1:?BUILD} packages=${2:?FOLDER}
rm -rf "$packages"
mkdir -p "$packages"
(cd "$build_dir" && umask 022 && cpack -G DEB -B "$packages" >"$packages/cpack.log" 2>&1) ||
  { cat "$packages/cpack.log" >&2; die "cpack failed"; }
rm -rf "$packages/_CPack_Packages"
command -v lintian >/dev/null || { say "run: lintian is not installed: the packages are not checked"; exit 0; }
say "run: checking the packages"
# They are not uploaded to Debian: no report there asks for them.
lintian --allow-root --fail-on error --tag-display-limit 0 --suppress-tags initial-upload-closes-no-bugs \
  "$packages"/*.deb >&2 || die "lintian found faults in the packages of $packages"
