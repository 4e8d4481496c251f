#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# installed_test.sh SOURCE BUILD [PYTHON]: installs into a prefix, moves it, and uses it as a stranger would: the example
# is built with find_package and run, the program queries its map, each header compiles alone, nothing but the facade is
# exported. With PYTHON, the interpreter of the module, the Python example runs too.
set -euo pipefail
source_dir=$1 build_dir=$2 python=${3:-}
work=$build_dir/installed_test
prefix=$work/moved
unset CLUXEL_HOME LD_LIBRARY_PATH

fail() { printf 'installed_test: %s\n' "$*" >&2; exit 1; }
wants() { grep -qE -- "$2" "$1" || { cat "$1" >&2; fail "$1 has no line like '$2'"; }; }

rm -rf "$work"
mkdir -p "$work/empty"
cmake --install "$build_dir" --prefix "$work/first" >"$work/install.log"
mv "$work/first" "$prefix"
lib=$(dirname "$(find "$prefix" -name libcluxel.so)")

# The installed tree is complete and holds nothing private.
(cd "$source_dir/include" && find cluxel -name '*.hpp' | sort) >"$work/headers.wanted"
(cd "$prefix/include" && find . -type f | sed 's|^\./||' | sort) >"$work/headers.found"
diff "$work/headers.wanted" "$work/headers.found" || fail "the installed headers are not those of include/"
[ "$(wc -l <"$work/headers.found")" -le 25 ] || fail "more than 25 headers are installed"
for folder in ontology rules queries models labels; do
  [ -d "$prefix/share/cluxel/$folder" ] || fail "share/cluxel/$folder is not installed"
done
[ -f "$lib/cluxel/redland/librdf_storage_cluxel.so" ] || fail "the Redland module is not installed"
if grep -rIlE "$build_dir|$work/first" "$lib/cmake" "$prefix/include"; then fail "the package names folders of the build"; fi

# Each header compiles alone, without any other package's headers.
while read -r header; do
  printf '#include <%s>\n' "$header" >"$work/alone.cpp"
  "${CXX:-c++}" -std=c++20 -Wall -Wextra -Werror -pedantic -fsyntax-only -I"$prefix/include" "$work/alone.cpp" ||
    fail "$header does not compile alone"
done <"$work/headers.found"

# The library exports the facade, each module its entry. No start loads PCL, and nothing has a run path.
nm -DC --defined-only "$lib/libcluxel.so" | sed 's/^[0-9a-f]* //' >"$work/exports"
wants "$work/exports" ' cluxel::Map::open'
wants "$work/exports" 'typeinfo for cluxel::InputError'
if grep -vE 'cluxel::' "$work/exports"; then fail "libcluxel.so exports what is not Cluxel's"; fi
if grep -m5 -E ' cluxel::(scan|perception|rdf|sparql|rules|mapping|tasks)::' "$work/exports"; then
  fail "libcluxel.so exports private functions"
fi
nm -D --defined-only "$lib/cluxel/redland/librdf_storage_cluxel.so" >"$work/redland_exports"
wants "$work/redland_exports" ' T librdf_storage_module_register_factory$'
nm -D --defined-only "$lib/cluxel/cluxel_pcl.so" >"$work/pcl_exports"
wants "$work/pcl_exports" ' T cluxelPclFunctions$'
if objdump -p "$prefix/bin/cluxel" "$lib/libcluxel.so.0" | grep 'NEEDED.*pcl'; then fail "PCL is loaded by each start"; fi
if objdump -p "$prefix/bin/cluxel" "$lib/libcluxel.so.0" | grep -E 'R(UN)?PATH'; then fail "a run path is set"; fi

# The example, built against the package, from a folder without data.
cd "$work/empty"
cmake -S "$source_dir/examples/cpp" -B "$work/example" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release \
  >"$work/example.log" || { cat "$work/example.log" >&2; fail "find_package(cluxel) failed"; }
cmake --build "$work/example" >>"$work/example.log" || { cat "$work/example.log" >&2; fail "examples/cpp does not build"; }
example=$work/example/example
"$prefix/bin/cluxel" --version >"$work/version"
wants "$work/version" '^cluxel [0-9]+\.[0-9]+\.[0-9]+'
"$prefix/bin/cluxel" simulate "$work/scans" --stops 2 --size 45 --points-per-stop 20000 >"$work/simulate.log"
"$example" "$work/scans" "$work/campus.clx" >"$work/example.out"
wants "$work/example.out" '^[1-9][0-9]* objects, '
wants "$work/example.out" 'why:'

# The Python module finds the library and the data of the moved installation, and builds the same map.
if [ -n "$python" ]; then
  module=$(dirname "$(find "$prefix" -name 'cluxel.*.so')")
  [ -f "$module/cluxel.pyi" ] || fail "the types of the Python module are not installed"
  objdump -p "$module"/cluxel.*.so >"$work/module_headers"
  wants "$work/module_headers" 'RUNPATH +\$ORIGIN/[./a-z0-9_-]*$'
  PYTHONPATH=$module PYTHONDONTWRITEBYTECODE=1 "$python" "$source_dir/examples/python/build_and_ask.py" "$work/scans" \
    "$work/python.clx" >"$work/python.out" || fail "the Python example failed"
  wants "$work/python.out" '^[1-9][0-9]* trees, on average'
  for map in campus python; do "$prefix/bin/cluxel" export --canonical "$work/$map.clx" -o "$work/$map.nq" 2>/dev/null; done
  cmp "$work/campus.nq" "$work/python.nq" || fail "C++ and Python built different maps"
fi

# An error crosses the border of the library with its type and place.
printf '1 2 3\n4 five 6\n' >"$work/faulty.xyz"
if "$example" "$work/faulty.xyz" "$work/faulty.clx" 2>"$work/faulty.err"; then fail "a faulty scan was taken"; fi
wants "$work/faulty.err" 'faulty\.xyz:2'

# The installed program finds its own data; a folder that lies in the working directory is not read.
mkdir -p ontology rules queries models labels
echo 'no query' >queries/objects.rq
"$prefix/bin/cluxel" query "$work/campus.clx" objects.rq --format csv >"$work/query.csv"
[ "$(wc -l <"$work/query.csv")" -gt 1 ] || fail "the installed program finds no objects"
"$prefix/bin/cluxel" tasks >"$work/tasks.txt"
wants "$work/tasks.txt" '^trees$'
echo "installed_test: passed"
