#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Writes the outdoor rules as they are before any fit: evidence at 0, and the confidences that the rules had before
# evidence came. It is where bench/fit_left_out.sh starts.
# Usage: bench/unfitted_rules.py RULES OUT
import re
import sys

# By rule, in the order of its leaves; "a-b" is a ramp. Leaves that are not named keep theirs.
CONFIDENCES = {
    "building/facades": ["0.60-0.96", "0.60"], "building/roof": ["0.75"], "building/fragments": ["0.85", "0.75"],
    "utility_pole/mast": ["0.88"], "tree/trunk-and-top": ["0.70-0.97"], "tree/trunk-below-top": ["0.70"],
    "tree/trunk-alone": ["0.50", "0.50"], "tree/large-top-alone": ["0.45-0.75"], "tree/crown-fragments": ["0.80"],
    "tree/top-alone": ["0.45-0.75", "0.60"], "street_lamp/pole": ["0.2-0.6", "0.1-0.25"], "street_lamp/head": ["0.80", "0.55"],
    "street_sign/pole-and-plate": ["0.75-0.95", "0.60"], "vehicle/car": ["0.88", "0.65"], "vehicle/any": ["0.50"],
    "vehicle/lorry": ["0.60"], "person/upright": ["0.60"], "bush/low-scatter": ["0.55-0.92"],
    "small_object/rest": ["0.60"],
}
MASTS = ("from: 0.95, to: 0.98", "from: 0.90, to: 0.97")  # three leaves of masts share a definition


def without_evidence(line):
    if not line.lstrip().startswith(("- { measure:", "- { when:")):
        return line
    line = re.sub(r"curve: \{.*?\}", lambda curve: re.sub(r": -?[\d.]+", ": 0", curve[0]), line)
    return re.sub(r"weight: -?[\d.]+", "weight: 0", line)


def main():
    rule, written = None, {}

    def confidence(match):
        known, number = CONFIDENCES.get(rule, []), written.get(rule, 0)
        written[rule] = number + 1
        if number >= len(known):
            return match[0]
        low, dash, high = known[number].partition("-")
        return f"confidence: {{ from: {low}, to: {high}" if dash else f"confidence: {low}"

    lines = []
    with open(sys.argv[1], encoding="utf-8") as file:
        for line in file:
            begins = re.match(r"  - id: (\S+)", line)
            rule = begins[1] if begins else rule
            if "sure_when_high: {" in line:
                line = line.replace(*MASTS)
            line = without_evidence(line)
            if rule:
                line = re.sub(r"confidence: (\{ from: [\d.]+, to: [\d.]+|[\d.]+)", confidence, line)
            lines.append(line)
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.writelines(lines)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: bench/unfitted_rules.py RULES OUT")
    main()
