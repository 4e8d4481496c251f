#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Adds up evaluations (JSON of `cluxel evaluate --json`) and prints them as Markdown tables.
# Usage: accuracy_tables.py OUT            the bars and the tables of all parts that bench/accuracy.sh left in OUT
#        accuracy_tables.py FILE.json...   the tables of the sum of these files
import glob
import json
import math
import os
import sys

# Part of OUT, files in it, title.
PARTS = [
    ("oakland", "fold?.json", "Oakland, five folds by pairs of chunks (place-out)"),
    ("oakland", "half_ac_ah.json", "Oakland, trained on ac to ah, judged on ai to ao"),
    ("oakland", "half_ai_ao.json", "Oakland, trained on ai to ao, judged on ac to ah"),
    ("sydney", "oakland.json", "Sydney, single scans, model `oakland` (sensor-out)"),
    ("sydney", "campus.json", "Sydney, single scans, model `campus` (sensor-out)"),
    ("sydney_halves", "*.json", "Sydney, with the other half of its scans in training"),
    ("nuscenes", "oakland.json", "nuScenes, single scans, model `oakland` (sensor-out)"),
    ("nuscenes", "campus.json", "nuScenes, single scans, model `campus` (sensor-out)"),
    ("kitti", "oakland.json", "KITTI 00, single scans, model `oakland` (sensor-out)"),
    ("kitti", "campus.json", "KITTI 00, single scans, model `campus` (sensor-out)"),
    ("campus", "*.oakland.json", "Campus 901 to 903 (generated data), model `oakland`"),
    ("campus", "*.campus.json", "Campus 901 to 903 (generated data), model `campus`"),
    ("stops", "campus.json", "Campus 904, 77 stop-and-go scans (generated data), model `campus`"),
]
EXPECTED_ERRORS = {"oakland": 0.03, "sydney": 0.06, "sydney_halves": 0.06, "nuscenes": 0.06, "kitti": 0.06}   # largest, of calibration
FOLDS = 5
POLES_AND_TRUNKS = ("pole", "trunk")
Z = 1.959963984540054   # 97.5 % quantile of the normal distribution


def ratio(part, whole):
    return part / whole if whole else 0.0


def harmonic(a, b):
    return 2 * a * b / (a + b) if a + b else 0.0


def wilson(hits, total):
    """The limits of Wilson's 95 % interval of a share."""
    if total <= 0:
        return 0.0, 1.0
    share, scale = hits / total, 1 + Z * Z / total
    center = (share + Z * Z / (2 * total)) / scale
    half = Z / scale * math.sqrt(share * (1 - share) / total + Z * Z / (4 * total * total))
    return max(0.0, center - half), min(1.0, center + half)


def with_interval(share, total):
    if total <= 0:
        return "-"
    low, high = wilson(share * total, total)
    return f"{share:.3f} ({low:.2f} to {high:.2f})"


class PointCounts:
    """Counts of points by true class and answer."""

    def __init__(self, files, key):
        self.counts = {}
        for evaluation in files:
            for row in evaluation[key]["classes"]:
                into = self.counts.setdefault(row["class"], {})
                for answer, count in row["answers"].items():
                    into[answer] = into.get(answer, 0) + count

    def figures(self, name):
        """precision, recall, F1, IoU, points."""
        truth = sum(self.counts[name].values())
        answers = sum(row.get(name, 0) for row in self.counts.values())
        hits = self.counts[name].get(name, 0)
        precision, recall = ratio(hits, answers), ratio(hits, truth)
        return precision, recall, harmonic(precision, recall), ratio(hits, truth + answers - hits), truth

    def with_truth(self):
        return [name for name in self.counts if sum(self.counts[name].values())]

    def macro(self, column):
        names = self.with_truth()
        return ratio(sum(self.figures(name)[column] for name in names), len(names))

    def overall(self):
        return ratio(sum(row.get(name, 0) for name, row in self.counts.items()), self.total())

    def total(self):
        return sum(sum(row.values()) for row in self.counts.values())

    def table(self, title):
        lines = [f"**{title}**\n", "| class | precision | recall | F1 | IoU | points |", "|---|---|---|---|---|---|"]
        for name in self.with_truth():
            precision, recall, f1, iou, points = self.figures(name)
            lines.append(f"| {name} | {precision:.3f} | {recall:.3f} | {f1:.3f} | {iou:.3f} | {points} |")
        lines.append(f"\nOverall accuracy {self.overall():.4f}, macro F1 {self.macro(2):.3f}, "
                     f"macro IoU {self.macro(3):.3f}, {self.total()} points.\n")
        return "\n".join(lines)


class ObjectCounts:
    """Counts of objects by class: true, answered, matched true, matched answers."""

    FIELDS = ("truth", "answers", "matched_truth", "matched_answers")

    def __init__(self, files, key):
        self.covers_all = all(evaluation.get("coverage", "all") == "all" for evaluation in files)
        self.sums = {}
        for evaluation in files:
            for row in evaluation.get(key, []):
                into = self.sums.setdefault(row["class"], [0, 0, 0, 0])
                for i, field in enumerate(self.FIELDS):
                    into[i] += row[field]
        self.sums["all"] = [sum(values[i] for values in self.sums.values()) for i in range(4)]

    def precision(self, name):
        return ratio(self.sums[name][3], self.sums[name][1])

    def recall(self, name):
        return ratio(self.sums[name][2], self.sums[name][0])

    def f1(self, name):
        return harmonic(self.precision(name), self.recall(name))

    def table(self, title):
        lines = [f"**{title}**\n"]
        if self.covers_all:
            lines += ["| class | precision | recall | F1 | true objects | found |", "|---|---|---|---|---|---|"]
        else:
            lines += ["| class | recall | true objects |", "|---|---|---|"]
        for name, (truth, answers, _, _) in self.sums.items():
            recall = with_interval(self.recall(name), truth)
            if self.covers_all and truth + answers:
                precision = with_interval(self.precision(name), answers)
                f1 = with_interval(self.f1(name), (truth + answers) / 2)
                lines.append(f"| {name} | {precision} | {recall} | {f1} | {truth} | {answers} |")
            elif truth:
                lines.append(f"| {name} | {recall} | {truth} |")
        return "\n".join(lines) + "\n"


class KindCounts:
    """What labelled objects are called, by the data set's own kinds."""

    def __init__(self, files):
        self.truth, self.found, self.called, self.boxed = {}, {}, {}, {}
        for evaluation in files:
            for row in evaluation.get("objects_by_kind", []):
                kind = row["kind"]
                self.truth[kind] = self.truth.get(kind, 0) + row["truth"]
                for sums, key in ((self.found, "found"), (self.called, "called"), (self.boxed, "boxed")):
                    into = sums.setdefault(kind, {})
                    for name, count in row.get(key, {}).items():
                        into[name] = into.get(name, 0) + count

    def share(self, sums, kinds, classes):
        """The share of objects of these kinds that have one of these classes, and their number."""
        total = sum(self.truth.get(kind, 0) for kind in kinds)
        hits = sum(sums.get(kind, {}).get(name, 0) for kind in kinds for name in classes)
        return ratio(hits, total), total

    def table(self):
        lines = ["**Labelled objects by kind**: the class of the object that is their partner (IoU of points at least "
                 "0.5), and of the object that has the most of their points\n",
                 "| kind | objects | partner | most points |", "|---|---|---|---|"]
        words = lambda counts: ", ".join(f"{name} {counts[name]}" for name in sorted(counts, key=lambda n: -counts[n]))
        for kind in sorted(self.truth):
            lines.append(f"| {kind} | {self.truth[kind]} | {words(self.found[kind])} | {words(self.called[kind])} |")
        return "\n".join(lines) + "\n"


def print_tables(files):
    print(PointCounts(files, "primitives_by_point").table("Primitives by point"))
    print(PointCounts(files, "objects_by_point").table("Objects by point"))
    if not any("objects_by_point_set" in evaluation for evaluation in files):
        return
    print(ObjectCounts(files, "objects_by_point_set").table("Objects by object, point sets with IoU of at least 0.5"))
    print(ObjectCounts(files, "objects_by_box").table("Objects by object, boxes with IoU of at least 0.8** (the "
                                                      "paper's measure)**").replace("****", ""))
    print(box_confusion(files))
    kinds = KindCounts(files)
    if any(not evaluation.get("coverage", "all") == "all" for evaluation in files):
        print(kinds.table())


def calibration(files):
    """The expected calibration error of the sum, that of exact confidences by chance, and the number of objects."""
    bins = {}
    for evaluation in files:
        for i, row in enumerate(evaluation.get("calibration", {}).get("bins", [])):
            into = bins.setdefault(i, [0, 0, 0.0, 0.0])
            for field, key in enumerate(("objects", "right", "confidence_sum", "variance_sum")):
                into[field] += row.get(key, 0)
    objects = sum(values[0] for values in bins.values())
    by_chance = sum(math.sqrt(2 / math.pi * values[3]) for values in bins.values())
    return ratio(sum(abs(values[2] - values[1]) for values in bins.values()), objects), ratio(by_chance, objects), objects


def box_confusion(files):
    """The paper's table: true objects against the class of the object with their box; and found objects."""
    kinds = KindCounts(files)
    columns = sorted({name for counts in kinds.boxed.values() for name in counts if name != "none"}) + ["none"]
    lines = ["**Confusion of objects, boxes with IoU of at least 0.8** (the paper's table)\n",
             "| true \\ found | " + " | ".join(columns) + " | objects |", "|---" * (len(columns) + 2) + "|"]
    for kind in sorted(kinds.truth):
        cells = " | ".join(str(kinds.boxed[kind].get(name, 0)) for name in columns)
        lines.append(f"| {kind} | {cells} | {kinds.truth[kind]} |")
    return "\n".join(lines) + "\n"


def crown_pairs(files):
    sums = [sum(evaluation.get("crown_pairs", {}).get(key, 0) for evaluation in files) for key in ("parted", "pairs")]
    return ratio(*sums), sums[1]


def oakland_bars(files):
    primitives, points = PointCounts(files, "primitives_by_point"), PointCounts(files, "objects_by_point")
    objects = ObjectCounts(files, "objects_by_point_set")
    yield "primitives, overall accuracy", primitives.overall(), 0.98, None
    yield "primitives, macro F1", primitives.macro(2), 0.90, None
    yield "primitives, F1 of columns", primitives.figures("column")[2], 0.72, None
    yield "objects by point, macro F1", points.macro(2), 0.80, None
    for name, bar in (("all", 0.75), ("StreetSign", 0.60), ("UtilityPole", 0.70), ("Bush", 0.45)):
        truth, answers = objects.sums[name][:2]
        yield f"objects by object, F1 of {name}", objects.f1(name), bar, (truth + answers) / 2


def campus_bars(files):
    share, total = crown_pairs(files)
    yield "pairs of touching crowns that are parted", share, 0.90, total


def half_bars(files):
    yield "objects by point, macro F1", PointCounts(files, "objects_by_point").macro(2), 0.75, None


def sydney_bars(files):
    objects, kinds = ObjectCounts(files, "objects_by_point_set"), KindCounts(files)
    recall = lambda name: (objects.recall(name), objects.sums[name][0])
    share, total = recall("StreetSign")
    yield "traffic signs found", share, 0.70, total
    share, total = kinds.share(kinds.called, POLES_AND_TRUNKS + ("traffic_lights",), ["StreetSign"])
    yield "trunks, poles and traffic lights called signs (at most)", share, -0.10, total
    share, total = kinds.share(kinds.found, POLES_AND_TRUNKS, ["Pole", "Tree"])
    yield "poles and trunks found as Pole or Tree", share, 0.75, total
    for name, bar in (("Vehicle", 0.80), ("Person", 0.80)):
        share, total = recall(name)
        yield f"{name} found", share, bar, total


def nuscenes_bars(files):
    yield "objects by point, macro F1", PointCounts(files, "objects_by_point").macro(2), 0.80, None


def kitti_bars(files):
    points = PointCounts(files, "objects_by_point")
    yield "primitives, macro F1", PointCounts(files, "primitives_by_point").macro(2), 0.75, None
    yield "vehicles by point, F1", points.figures("Vehicle")[2], 0.90, None
    yield "signs by point, F1", points.figures("StreetSign")[2], 0.50, None


def bars_of(part, pattern):
    if part == "oakland":
        return half_bars if pattern.startswith("half") else oakland_bars
    return {"sydney": sydney_bars, "sydney_halves": sydney_bars, "nuscenes": nuscenes_bars, "kitti": kitti_bars}.get(part, campus_bars)


def all_bars(part, pattern, files):
    yield from bars_of(part, pattern)(files)
    error, by_chance, objects = calibration(files)
    if part in EXPECTED_ERRORS and objects:
        yield f"confidence, expected calibration error over {objects} objects, by chance {by_chance:.3f} (at most)", error, -EXPECTED_ERRORS[part], None


def load(names):
    files = []
    for name in names:
        with open(name) as file:
            files.append(json.load(file))
    return files


def print_bars(out):
    print("| data | measure | value | bar | holds |\n|---|---|---|---|---|")
    for part, pattern, title in PARTS:
        files = load(sorted(glob.glob(f"{out}/{part}/{pattern}")))
        if pattern == "fold?.json" and 0 < len(files) < FOLDS:
            title += f", only {len(files)} of them"
        for what, value, bar, total in all_bars(part, pattern, files) if files else ():
            if total == 0:
                continue
            holds = value <= -bar if bar < 0 else value >= bar
            shown = with_interval(value, total) if total is not None else f"{value:.3f}"
            print(f"| {title} | {what} | {shown} | {abs(bar):.2f} | {'yes' if holds else 'no'} |")
    print()


def main():
    names = sys.argv[1:]
    if not names:
        sys.exit("usage: accuracy_tables.py OUT | FILE.json...")
    if not os.path.isdir(names[0]):
        print_tables(load(names))
        return
    print_bars(names[0])
    for part, pattern, title in PARTS:
        files = load(sorted(glob.glob(f"{names[0]}/{part}/{pattern}")))
        if files:
            print(f"## {title}\n\nSum of {len(files)} evaluations.\n" if len(files) > 1 else f"## {title}\n")
            print_tables(files)


main()
