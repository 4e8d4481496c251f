#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tries Cluxel on clean Debian 12 machines, made by debootstrap: fresh.sh [--cache] [--packages] [PATH]. Needs root.
# The first machine holds a clone of HEAD, in which the README's two commands run and the packages are made. The second
# one has no checkout: it installs the packages and uses them (tests/install/packages_test.sh). --packages: only the
# second one, with packages made on this machine.
# Mounts are made in a mount namespace of their own, so that none is left behind however this ends, and none can be
# deleted with the folder.
source "$(dirname "$0")/common.sh"

# What this machine knows about its network, for the clean one: proxies, certificates, npm's settings.
network_settings() {
  env | grep -iE '^((http|https|ftp|all|no)_proxy|ssl_cert_file|ssl_cert_dir|node_extra_ca_certs|npm_config_[a-z_]*|ci|cluxel_jobs)=' || true
}

# The machine's own certificates, where it has some, and files that its settings name.
copy_certificates() {  # copy_certificates ROOT
  local root=$1 file
  if ls /usr/local/share/ca-certificates/*.crt >/dev/null 2>&1; then
    cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/"
    chroot "$root" update-ca-certificates >/dev/null 2>&1
  fi
  for file in "${SSL_CERT_FILE:-}" "${NODE_EXTRA_CA_CERTS:-}"; do
    case "$file" in '' | /etc/ssl/certs/*) continue ;; esac
    if [ -f "$file" ]; then install -D -m 644 "$file" "$root$file"; fi
  done
}

make_clean_debian() {  # make_clean_debian ROOT
  local root=$1 mirror cache="$PWD/build/fresh-packages"
  mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null |
    sed -n 's/^deb \(\[[^]]*\] \)\?\([^ ]*\).*/\2/p; s/^URIs: *\([^ ]*\).*/\1/p' | head -1 || true)
  mkdir -p "$cache"
  say "run: making a clean Debian 12 in $root"
  debootstrap --variant=minbase --include=ca-certificates --cache-dir="$cache" bookworm "$root" ${mirror:+"$mirror"} >&2 ||
    die "debootstrap failed: is the network there?"
  find /etc/apt/apt.conf.d -type f ! -name 'docker-*' -exec cp {} "$root/etc/apt/apt.conf.d/" \;
  printf 'APT::Keep-Downloaded-Packages "true";\nBinary::apt-get::APT::Keep-Downloaded-Packages "true";\n' >"$root/etc/apt/apt.conf.d/99fresh"
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/fresh"
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  copy_certificates "$root"
  if [ -f "${HOME}/.npmrc" ]; then cp "${HOME}/.npmrc" "$root/root/.npmrc"; fi
}

run_in_clean_debian() {  # run_in_clean_debian ROOT CHECKOUT CACHE FOLDER COMMAND
  local root=$1 checkout=$2 cache=$3 shared settings
  shared=$(dirname "$checkout")/shared
  mount -t proc proc "$root/proc" || say "run: no /proc in the clean machine"
  mount --bind "$checkout/build/fresh-packages" "$root/var/cache/apt/archives"
  if [ -d "$shared" ]; then
    mkdir -p "$root$shared"
    mount --bind "$shared" "$root$shared"
    mount -o remount,bind,ro "$root$shared"
  fi
  if [ -n "$cache" ]; then
    mkdir -p "$root/root/.cache/ccache" "$root/root/.config"
    mount --bind "$cache" "$root/root/.cache/ccache"
    if [ -d "$HOME/.config/ccache" ]; then cp -r "$HOME/.config/ccache" "$root/root/.config/"; fi
  fi
  mapfile -t settings < <(network_settings)
  chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 "${settings[@]}" \
    bash -c "cd '$4' && $5"
}

in_namespace() {  # in_namespace FOLDER COMMAND: runs COMMAND in FOLDER of the clean machine
  # shellcheck disable=SC2016  # the inner shell expands "$@"
  unshare --mount --propagation private bash -c 'run_in_clean_debian "$@"' fresh "$root" "$PWD" "$cache" "$1" "$2"
}

try_clone() {
  make_clean_debian "$root"
  mkdir -p "$(dirname "$root$PWD")"
  git clone -q . "$root$PWD"
  in_namespace "$PWD" './run demo && ./run test && ./run package' || die "the clone failed on a clean machine; it lies in $root"
  rm -rf "$debs"
  cp -r "$root$PWD/build/packages" "$debs"
  rm -rf --one-file-system "$root"
  say "run: demo, test and package passed on a clean Debian 12"
}

try_packages() {
  local folder=/root/packages
  make_clean_debian "$root"
  mkdir -p "$root$folder"
  cp "$debs"/*.deb README.md tests/docs/run_documents.py tests/install/packages_test.sh "$root$folder/"
  in_namespace "$folder" 'bash packages_test.sh .' || die "the packages failed on a clean machine; it lies in $root"
  rm -rf --one-file-system "$root"
  say "run: the packages passed on a clean Debian 12"
}

[ "$(id -u)" = 0 ] || die "fresh needs root, for debootstrap and chroot"
install_packages debootstrap git
root=build/fresh cache='' packages_only='' debs=build/fresh-debs
for option in "$@"; do
  case "$option" in
    --cache) cache=$(ccache -k cache_dir) || die "--cache needs ccache" ;;
    --packages) packages_only=yes debs=build/packages ;;
    -*) die "unknown option '$option' of ./run fresh" 2 ;;
    *) root=$option ;;
  esac
done
mkdir -p "$root"
root=$(readlink -f "$root")
rm -rf --one-file-system "$root"
export -f run_in_clean_debian network_settings say
if [ -n "$packages_only" ]; then bash tools/package.sh >/dev/null; else try_clone; fi
try_packages
