#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Adds up evaluations (JSON of `cluxel evaluate --json`) and prints them as the Markdown tables of docs/accuracy.md.
# Usage: accuracy_tables.py FILE.json...
import json
import sys


def add_points(files, key):
    counts = {}
    for evaluation in files:
        for row in evaluation[key]["classes"]:
            into = counts.setdefault(row["class"], {})
            for answer, count in row["answers"].items():
                into[answer] = into.get(answer, 0) + count
    return counts


def ratio(part, whole):
    return part / whole if whole else 0.0


def harmonic(a, b):
    return 2 * a * b / (a + b) if a + b else 0.0


def point_table(counts):
    print("| class | precision | recall | F1 | IoU | points |\n|---|---|---|---|---|---|")
    right = total = 0
    f1s, ious = [], []
    for name in counts:
        truth = sum(counts[name].values())
        answers = sum(row.get(name, 0) for row in counts.values())
        hits = counts[name].get(name, 0)
        precision, recall = ratio(hits, answers), ratio(hits, truth)
        iou = ratio(hits, truth + answers - hits)
        right, total = right + hits, total + truth
        if truth + answers == 0:
            continue
        if truth:
            f1s.append(harmonic(precision, recall))
            ious.append(iou)
        print(f"| {name} | {precision:.3f} | {recall:.3f} | {harmonic(precision, recall):.3f} | {iou:.3f} | {truth} |")
    print(f"\nOverall accuracy {ratio(right, total):.4f}, macro F1 {ratio(sum(f1s), len(f1s)):.3f}, "
          f"macro IoU {ratio(sum(ious), len(ious)):.3f}, {total} points.\n")


def object_table(files, key):
    sums = {}
    for evaluation in files:
        for row in evaluation.get(key, []):
            if row["class"] == "Ground":   # counts by point only
                continue
            into = sums.setdefault(row["class"], [0, 0, 0, 0])
            for i, field in enumerate(("truth", "answers", "matched_truth", "matched_answers")):
                into[i] += row[field]
    print("| class | precision | recall | F1 | true objects | found |\n|---|---|---|---|---|---|")
    sums["all"] = [sum(values[i] for values in sums.values()) for i in range(4)]
    for name, (truth, answers, matched_truth, matched_answers) in sums.items():
        if truth + answers == 0:
            continue
        precision, recall = ratio(matched_answers, answers), ratio(matched_truth, truth)
        print(f"| {name} | {precision:.3f} | {recall:.3f} | {harmonic(precision, recall):.3f} | {truth} | {answers} |")
    print()


def main():
    files = [json.load(open(name)) for name in sys.argv[1:]]
    print("**Primitives by point**\n")
    point_table(add_points(files, "primitives_by_point"))
    print("**Objects by point**\n")
    point_table(add_points(files, "objects_by_point"))
    if any("objects_by_point_set" in evaluation for evaluation in files):
        print("**Objects by object, point sets with IoU of at least 0.5**\n")
        object_table(files, "objects_by_point_set")
        print("**Objects by object, boxes with IoU of at least 0.8** (the paper's measure)\n")
        object_table(files, "objects_by_box")


main()
