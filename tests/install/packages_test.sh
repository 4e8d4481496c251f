#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# packages_test.sh FOLDER: installs the packages of FOLDER on a clean Debian and uses them as a stranger would, without a
# checkout: the README's first example, the Python module with its examples, the C++ example. FOLDER also holds README.md
# and run_documents.py. Run by `./run fresh`, as root of the clean machine.
set -euo pipefail
folder=$(readlink -f "$1")
examples=/usr/share/doc
export DEBIAN_FRONTEND=noninteractive

fail() { printf 'packages_test: %s\n' "$*" >&2; exit 1; }
say() { printf 'packages_test: %s\n' "$*" >&2; }
wants() { grep -qE -- "$2" "$1" || { cat "$1" >&2; fail "$1 has no line like '$2'"; }; }
add_packages() { apt-get install -y -qq --no-install-recommends "$@" >/tmp/apt.log 2>&1 || { cat /tmp/apt.log >&2; fail "apt-get could not install $*"; }; }

apt-get update -qq
say "installing the packages"
add_packages "$folder"/*.deb
work=$(mktemp -d)
cd "$work"

say "running the README's first example"
python3 "$folder/run_documents.py" --first --source "$work" --program /usr/bin "$folder/README.md" >readme.log || { cat readme.log >&2; fail "the README's first example failed"; }
wants readme.log '[1-9][0-9]* commands run, 0 faults'

say "running the Python examples"
cluxel simulate scans --stops 2 --size 45 --points-per-stop 20000 >simulate.log
python3 "$examples/python3-cluxel/examples/build_and_ask.py" scans python.clx >python.out
wants python.out '^[1-9][0-9]* trees, on average'
python3 "$examples/python3-cluxel/examples/points_by_class.py" python.clx >points.out
wants points.out "'tree': [1-9]"

say "building the C++ example"
add_packages cmake g++ make
cmake -S "$examples/libcluxel-dev/examples/cpp" -B build -DCMAKE_BUILD_TYPE=Release >build.log
cmake --build build >>build.log || { cat build.log >&2; fail "the C++ example does not build"; }
build/example scans cpp.clx >cpp.out
wants cpp.out '^[1-9][0-9]* objects, '
cluxel export --canonical python.clx -o python.nq
cluxel export --canonical cpp.clx -o cpp.nq
cmp python.nq cpp.nq || fail "C++ and Python built different maps"

say "removing the packages"
dpkg --purge python3-cluxel libcluxel-dev libcluxel0 cluxel cluxel-data >/dev/null
left=$(find /usr -path '*cluxel*' -not -path "$folder*" 2>/dev/null | head -5)
[ -z "$left" ] || fail "the removed packages left $left"
say "passed"
