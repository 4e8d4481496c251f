# SPDX-License-Identifier: Apache-2.0
# Counts the single tests in ctest's JUnit report, names outside data that is absent, and prints the closing line.
# One entry of ctest is one test, or a program that says how many it runs: a whole GoogleTest suite, or the W3C runner.
# A test that never reported its result, because the program crashed or ran out of time, has failed.

/^\t<testcase / {
  entry = $0
  status = attribute("status")
  name = attribute("name")
  announced = ok = skips = listed_passes = listed_failures = 0
  is_list = 0
  is_skip = status == "disabled"
}
/^\t\t<skipped message="SKIP_/ { is_skip = 1 }
/\[==========\] Running [0-9]+ tests? from / { announced = number_after("Running ") }
/\[       OK \] / { ++ok }
/\[  SKIPPED \] .* \([0-9]+ ms\)$/ { ++skips }
/^[0-9]+ passed, [0-9]+ failed$/ || /^\t\t<system-out>[0-9]+ passed, [0-9]+ failed$/ {
  sub(/^\t\t<system-out>/, "")
  is_list = 1
  listed_passes = $1
  listed_failures = $3
}
/outside data absent: / {
  text = substr($0, index($0, "outside data absent: "))
  gsub(/"|<.*/, "", text)
  ++absent[text]
}
/^\t<\/testcase>/ { count() }

function attribute(key, start, rest) {
  start = index(entry, " " key "=\"") + length(key) + 3
  rest = substr(entry, start)
  return substr(rest, 1, index(rest, "\"") - 1)
}

function number_after(words) { return substr($0, index($0, words) + length(words)) + 0 }

function count(good, bad, left_out) {
  if (is_list) {
    good = listed_passes
    bad = listed_failures
  } else {
    if (announced == 0) announced = 1
    if (is_skip) left_out = announced
    else left_out = skips
    if (status == "run") good = announced - left_out
    else if (!is_skip) good = ok
    bad = announced - left_out - good
  }
  # The program failed although each of its tests passed: a leak, say, or a crash at its end.
  if (status != "run" && !is_skip && bad == 0) {
    bad = 1
    if (good > 0) --good
  }
  passed += good
  failed += bad
  skipped += left_out
  if (bad > 0) print "run: failed: " name (bad > 1 ? " (" bad " tests)" : "") > "/dev/stderr"
}

END {
  for (text in absent) {
    if (!absent_count++) print "tests that did not run because data outside the repository is absent:"
    printf "%7d %s\n", absent[text], text
  }
  if (require_data != "" && absent_count) print "run: --require-data: outside data is absent" > "/dev/stderr"
  printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped
  exit failed > 0 || passed == 0 || (require_data != "" && absent_count > 0)
}
