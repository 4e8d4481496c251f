#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# What it costs to apply rules of which one threshold is a little other, against the build of the map.
# Usage: bench/threshold_cost.py CLUXEL OUT RULES SCANS...: a map of SCANS is built in OUT by the rule file RULES
# COUNT (24) comparisons of the file, evenly spaced, are taken one at a time, their number times FACTOR (1.02). With
# KIND, other numbers are taken instead: range, ratio, group, confidence, curve, weight, budget, split, slice or
# constant. What concerns nothing costs the same for every map; what has to be decided as a whole costs what it did
# before.
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

if len(sys.argv) < 5:
    sys.exit(next(line for line in open(__file__) if line.startswith("# Usage")).lstrip("# "))
cluxel, out, rules, scans = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), sys.argv[4:]
count, factor = int(os.environ.get("COUNT", "24")), float(os.environ.get("FACTOR", "1.02"))
measured = Path(__file__).with_name("measured.py")
out.mkdir(parents=True, exist_ok=True)


def seconds(*command, report=None):
    """Processor time, and the JSON that the command printed."""
    output = ["--output", str(report)] if report else []
    run = subprocess.run([measured, *output, cluxel, "--threads", "1", *command], capture_output=True, text=True)
    if run.returncode != 0:
        return None
    return float(run.stdout.split()[0])


NAME, NUMBER = r"[a-z_]+(?: (?:of|to) [a-zA-Z:]+)?", r"(-?[0-9.]+)"
PATTERNS = {
    "comparison": rf"{NAME} [<>]=? {NUMBER}",
    "range": rf"{NAME}(?: from [^,]*? to [0-9.]+ m)? between (?:[0-9.]+ ?[a-z0-9]* and )?{NUMBER}",
    "ratio": rf"{NAME} [<>]=? {NUMBER} x [a-z_]+",
    "group": rf"(?:near|horizontal|vertical): {NUMBER} m",
    "confidence": rf"(?:confidence:|confidence: {{ from:|from: [0-9.]+, to:) {NUMBER}",
    "curve": rf"measure: [a-z_]+[^,]*, curve: {{ [0-9.]+ ?[a-z]*: {NUMBER}",
    "weight": rf"when: [^,]*, weight: {NUMBER}",
    "budget": rf"max_fraction_of_points: {NUMBER}",
    "split": rf"(?:reach|jump|clearance|within|above): {NUMBER} m",
    "slice": rf"[a-z_]+ from {NUMBER} m to",
    "constant": rf"\n  [a-z_]+: {NUMBER} m",
}
kind = os.environ.get("KIND", "comparison")
text = rules.read_text()
tests = list(re.finditer(PATTERNS[kind], text))
built = seconds("build", *scans, "--rules", str(rules), "-o", str(out / "map.clx"), "--force")
folder = out / "rules"
shutil.copytree(rules.parent, folder, dirs_exist_ok=True)
rows, faulty = [], 0
for test in tests[:: max(1, len(tests) // count)]:
    number = f"{float(test.group(1)) * factor:.6g}"
    (folder / rules.name).write_text(text[: test.start(1)] + number + text[test.end(1):])
    shutil.copy(out / "map.clx", out / "other.clx")
    cost = seconds("rules", "apply", str(out / "other.clx"), "--rules", str(folder / rules.name), "--json",
                   report=out / "report.json")
    if cost is None:
        faulty += 1  # a number that may not be other, or that other numbers have to fit
        continue
    report = json.loads((out / "report.json").read_text())
    changed = sum(len(report["objects"][kind]) for kind in ("added", "gone", "changed", "split", "joined"))
    rows.append((cost, report["tiles_decided"], changed, test.group(0).strip()))
tiles = report["tiles"]
print(f"| test, its number times {factor} | tiles decided of {tiles} | objects that differ | [s] | of the build ({built:.2f} s) |")
print("|---|---|---|---|---|")
for cost, decided, changed, test in sorted(rows):
    print(f"| `{test}` | {decided} | {changed} | {cost:.2f} | {cost / built:.3f} |")
costs = sorted(row[0] for row in rows)
print(f"\n{len(rows)} rule files (and {faulty} that are faulty): median {statistics.median(costs):.2f} s, "
      f"{sum(row[1] == 0 for row in rows)} decide nothing anew, {sum(row[1] == tiles for row in rows)} everything")
