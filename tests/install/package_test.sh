#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# package_test.sh SOURCE BUILD PYTHON: makes the Debian packages, and checks what they hold and depend on. Unpacked
# together they are a working installation. On a clean machine they are tried by packages_test.sh.
set -euo pipefail
source_dir=$1 build_dir=$2 python=$3
work=$build_dir/package_test
root=$work/root
unset CLUXEL_HOME LD_LIBRARY_PATH

fail() { printf 'package_test: %s\n' "$*" >&2; exit 1; }
field() { dpkg-deb --field "$work/packages/$1"_*.deb "$2"; }
depends() {  # depends PACKAGE PATTERN...
  local pattern depends
  depends=$(field "$1" Depends)
  for pattern in "${@:2}"; do grep -qE -- "(^|, )$pattern(,|$)" <<<"$depends" || fail "$1 does not depend on $pattern: $depends"; done
}

rm -rf "$work"
mkdir -p "$root"
bash "$source_dir/tools/make_packages.sh" "$build_dir" "$work/packages"
names=$(for file in "$work"/packages/*.deb; do dpkg-deb --field "$file" Package; done | sort | paste -sd' ')
[ "$names" = "cluxel cluxel-data libcluxel-dev libcluxel0 python3-cluxel" ] || fail "the packages are $names"

# Dependencies: on libraries as linked, on each other with equal versions.
version=$(field cluxel Version)
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+-[0-9]+$ ]] || fail "'$version' is no version of a package"
same="\\(= ${version//./\\.}\\)"
depends cluxel "cluxel-data $same" "libcluxel0 $same" 'librdf0 \(.*\)' 'libembree3-3 \(.*\)'
depends libcluxel0 "cluxel-data $same" 'libpcl-io[0-9.]+ \(.*\)' 'liblmdb0 \(.*\)' 'libzstd1 \(.*\)' 'libproj[0-9]+ \(.*\)'
depends libcluxel-dev "libcluxel0 $same"
depends python3-cluxel "libcluxel0 $same" 'python3 \(>= 3\.[0-9]+~\)' 'python3 \(<< 3\.[0-9]+\)' python3-numpy
[ "$(field cluxel-data Architecture)" = all ] || fail "cluxel-data is not for all architectures"

# Each installed file is in one package.
for file in "$work"/packages/*.deb; do
  dpkg-deb --fsys-tarfile "$file" | tar -t | grep -v '/$' | sed 's|^\./usr/||'
  dpkg-deb --extract "$file" "$root"
done | sort >"$work/packed"
[ -z "$(uniq -d "$work/packed")" ] || fail "in two packages: $(uniq -d "$work/packed")"
cmake --install "$build_dir" --prefix "$work/installed" >"$work/install.log"
(cd "$work/installed" && find . \( -type f -o -type l \) -not -path './share/zsh/*' | sed 's|^\./||' | sort) >"$work/installed_files"
missing=$(comm -13 "$work/packed" "$work/installed_files")
[ -z "$missing" ] || fail "in no package: $missing"
for folder in "$root"/usr/share/doc/*; do
  for file in copyright changelog.gz changelog.Debian.gz; do [ -s "$folder/$file" ] || fail "$folder has no $file"; done
done

# Unpacked together, program and Python module work, and no file names a folder of the build.
"$root/usr/bin/cluxel" --version >"$work/version"
module=$root/usr/lib/python3/dist-packages
PYTHONPATH=$module PYTHONDONTWRITEBYTECODE=1 "$python" -c 'import cluxel; print("cluxel", cluxel.__version__)' >"$work/module_version"
[ "$(head -1 "$work/version" | cut -d' ' -f1,2)" = "$(cat "$work/module_version")" ] || fail "program and module have different versions"
if grep -rlF "$build_dir" "$root"; then fail "the files above name the folder of the build"; fi
echo "package_test: passed"
