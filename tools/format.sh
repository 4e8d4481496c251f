#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Formats all C++ sources; with --check it names those that are not formatted, and changes nothing.
source "$(dirname "$0")/common.sh"

readonly version=14 exit_skipped=77   # Debian 12's clang-format: other versions format differently

sources() { find . \( -path ./build -o -path ./out -o -name '.*' ! -name . \) -prune -o -name '*.[ch]pp' -print0; }

# Prints the program to call, or nothing when this machine has none of that version.
formatter() {
  local program
  for program in "clang-format-$version" clang-format; do
    if "$program" --version 2>/dev/null | grep -q "version $version\."; then
      echo "$program"
      return
    fi
  done
}

check() {  # check PROGRAM
  local findings status=0
  findings=$(sources | xargs -0 -P "$jobs" -n 40 "$1" --dry-run -Werror 2>&1) || status=$?
  [ "$status" != 0 ] || return 0
  sed -n 's/^\(\.\/\)\?\(.*\):[0-9]*:[0-9]*: error: .*wclang-format-violations.*/\2/Ip' <<<"$findings" | sort -u |
    grep . || printf '%s\n' "$findings"
  die "the files above are not formatted: './run format' does it"
}

case "${1:-}" in
  --check)
    program=$(formatter)
    if [ -z "$program" ]; then
      say "run: skipped: clang-format $version is not installed"
      exit "$exit_skipped"
    fi
    check "$program"
    ;;
  '')
    [ -n "$(formatter)" ] || install_packages clang-format
    program=$(formatter)
    [ -n "$program" ] || die "clang-format $version is not installed, other versions format differently"
    sources | xargs -0 -P "$jobs" -n 40 "$program" -i
    ;;
  *) die "unknown option '$1' of ./run format" 2 ;;
esac
