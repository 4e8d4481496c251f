#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/count_tests.awk counts a report that holds each way in which a test can end: crashes and missing programs too.
set -euo pipefail
cd "$(dirname "$0")"

count() { LC_ALL=C awk -v require_data="$1" -f ../../tools/count_tests.awk report.xml 2>/dev/null; }

status=0
counted=$(count '') || status=$?
diff <(sort report.expected) <(sort <<<"$counted")
[ "$(tail -1 <<<"$counted")" = "17 passed, 11 failed, 5 skipped" ]
[ "$status" = 1 ]

# Absent data is a fault only when it is required.
passing='<testcase name="a" status="run">'
absent='<testcase name="b" status="notrun">
\t\t<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
outside data absent: kitti00'
report() { printf '\t%b\n\t</testcase>\n' "$@"; }
report "$passing" "$absent" | awk -v require_data= -f ../../tools/count_tests.awk | grep -qx '1 passed, 0 failed, 1 skipped'
if report "$passing" "$absent" | awk -v require_data=1 -f ../../tools/count_tests.awk >/dev/null 2>&1; then exit 1; fi
