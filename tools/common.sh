# SPDX-License-Identifier: Apache-2.0
# What the scripts of tools/ share: messages, Debian packages, building a preset. Sourced by them, from the checkout's root.
# shellcheck shell=bash
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

jobs="${CLUXEL_JOBS:-$(nproc)}"

say() { printf '%s\n' "$*" >&2; }

die() {  # die MESSAGE [EXIT_CODE]
  say "run: $1"
  exit "${2:-1}"
}

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

# Installs those of the named Debian packages that are missing.
install_packages() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  [ "${#missing[@]}" = 0 ] && return 0
  say "run: installing from Debian: ${missing[*]}"
  as_root apt-get update -qq >&2 || die "apt-get update failed: is the network there?"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2 ||
    die "apt-get could not install: ${missing[*]}"
}

install_base() {
  local listed
  mapfile -t listed < <(grep -v '^#' packages.txt)
  install_packages "${listed[@]}"
}

install_clang() { install_packages clang libclang-rt-14-dev; }

# npm packages that tests use, beside the build, never in the repository: install_from_npm FOLDER MANIFEST PACKAGE TEST.
install_from_npm() {
  local folder=build/$1 manifest=$2 package=$3
  command -v node >/dev/null || install_packages nodejs
  command -v npm >/dev/null || install_packages npm
  [ -d "$folder/node_modules/$package" ] && return 0
  say "run: installing the npm package $package under $folder"
  mkdir -p "$folder"
  cp "$manifest" "$folder/"
  npm install --silent --no-fund --no-audit --no-package-lock --prefix "$folder" >&2 ||
    say "run: npm could not install $package: $4 will say that it is absent"
}

# The second SPARQL engine of the differential test.
install_second_engine() { install_from_npm npm tests/sparql/package.json oxigraph "the differential test"; }

# The SPARQL client that asks `cluxel serve`.
install_endpoint_client() {
  install_from_npm npm-endpoint tests/app/package.json @comunica/query-sparql "the test of the endpoint"
}

# Node, npm and the packages of web/package-lock.json under web/node_modules.
install_web_tools() {
  command -v node >/dev/null || install_packages nodejs
  command -v npm >/dev/null || install_packages npm
  [ web/node_modules/.package-lock.json -nt web/package-lock.json ] && return 0
  say "run: installing what the page is made of under web/node_modules"
  (cd web && npm ci --silent --ignore-scripts --no-fund --no-audit) >&2 &&
    touch web/node_modules/.package-lock.json
}

# Checks and bundles web/src into web/dist/page.html where a source is newer, or with --again.
build_web() {
  [ "${1:-}" = --again ] || [ ! -f web/dist/page.html ] ||
    [ -n "$(find web/src web/*.mjs web/package-lock.json -newer web/dist/page.html -print -quit)" ] || return 0
  say "run: making the page's program"
  (cd web && node node_modules/typescript/bin/tsc --noEmit && node build.mjs) >&2
}

# The page's program where it can be made; without it all but `cluxel view` works.
make_page() {
  { install_web_tools && build_web; } ||
    say "run: npm could not make the page's program: cluxel view will say that it is absent"
}

configure() {  # configure PRESET [OPTIONS OF CMAKE...]
  local log
  mkdir -p build
  log=$(mktemp build/configure.XXXXXX)
  cmake --preset "$@" >"$log" 2>&1 || { cat "$log" >&2; rm -f "$log"; die "configuring '$1' failed"; }
  rm -f "$log"
}

build() {  # build PRESET [TARGETS...]
  local preset=$1
  shift
  configure "$preset"
  say "run: building '$preset'"
  cmake --build --preset "$preset" -j "$jobs" ${1:+--target "$@"} >&2 || die "the build failed"
}
