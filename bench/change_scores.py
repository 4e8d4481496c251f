#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Scores `cluxel changes MAP --json` against the truth of a generated campus, of which it tells what the last visit changed.

Usage: change_scores.py CHANGES.json TRUTH_FOLDER [--points POINTS.csv] [--list]
       change_scores.py --sum SCORES...

Events. A truth event is something that is gone ("left", "cut", and the old place of "moved" and "replaced") or new
("arrived", and the new place of "moved" and "replaced"). It counts when both visits measure, or would
measure if it stood there, at least 20 points on it. A reported event matches one of the same kind when the boxes, padded by 0.1 m, overlap by an intersection over
union of 0.2, or the centre of the smaller one lies within the other; the best pairs first, one to one. A further report whose centre
lies within the box of a true event, padded by 0.5 m, is a piece of it: neither true nor false. That holds for events that
do not count, too. Of more than two visits the events of the last one are true; a report that matches an event of an earlier
visit is false, and counted as "stale", too.

States. For each object of the truth the reported object, or changed part of an object, whose box overlaps it most (intersection over union of at least
0.2) gives the state in the last visit: present, absent or not observed. In the truth an object is not observed when the
visit measures, or would measure, no point on it, and of no certain state below 20 points.
A changed part speaks for an object of the truth when they overlap by half. Bushes that were cut have a row of their own.
Lamps that were replaced are left out: another pole stands in the same place. Things behind a van ("hidden") count as all
others do, and are listed once more.
Of the objects that are not observed, those are counted that a report says to be gone: as a state, or as a change that
matches their box and no true event.

Points (`changes --points`), as the DynamicMap benchmark counts them. A point of an earlier scan is dynamic when its
object leaves or moves later, a point of a later scan when its object has arrived or moved. Static accuracy is the share
of static points that are not reported as changed, dynamic accuracy the share of dynamic points that are, associated
accuracy the root of their product. Objects that were cut or replaced are left out: no truth tells which of their points
stay.
"""
import csv
import datetime
import gzip
import json
import math
import os
import sys

PAD_M = 0.1
MIN_SEEN, NOT_SEEN = 20, 1


def box_of(row, prefix=""):
    return [[float(row[f"{prefix}{axis}{end}"]) for axis in "xyz"] for end in ("min", "max")]


def overlap(a, b):
    """Intersection over union of padded boxes; 1 when the centre of the smaller lies in the other."""
    share, sizes = 1.0, [1.0, 1.0]
    for axis in range(3):
        low = max(a[0][axis], b[0][axis]) - PAD_M
        high = min(a[1][axis], b[1][axis]) + PAD_M
        if high <= low:
            return 0.0
        share *= high - low
        for i, box in enumerate((a, b)):
            sizes[i] *= box[1][axis] - box[0][axis] + 2 * PAD_M
    return share / (sum(sizes) - share)


def holds_centre(a, b):
    small, large = sorted((a, b), key=lambda box: sum(box[1][i] - box[0][i] for i in range(3)))
    return all(large[0][i] - PAD_M <= (small[0][i] + small[1][i]) / 2 <= large[1][i] + PAD_M for i in range(3))


def lies_within(small, large):
    """The centre of the one lies in the other, padded by half a metre."""
    return all(large[0][i] - 0.5 <= (small[0][i] + small[1][i]) / 2 <= large[1][i] + 0.5 for i in range(3))


def match(reported, truth):
    """Pairs (reported, truth) of numbers, best first, one to one."""
    pairs = []
    for i, (kind, box, _) in enumerate(reported):
        for j, (true_kind, true_box, _) in enumerate(truth):
            if kind != true_kind:
                continue
            iou = overlap(box, true_box)
            if iou >= 0.2 or (iou > 0 and holds_centre(box, true_box)):
                pairs.append((-iou, i, j))
    left, right = {}, {}
    for _, i, j in sorted(pairs):
        if i not in left and j not in right:
            left[i], right[j] = j, i
    return left, right


def reported_events(changes):
    events = []
    for change in changes["changes"]:
        box = (change["box_m"]["min"], change["box_m"]["max"])
        kind = "new" if change["change"] == "appeared" else "gone"
        events.append((kind, box, (change.get("class") or "unnamed") + " " + change["change"]))
        if "now" in change:
            now = change["now"]["box_m"]
            events.append(("new", (now["min"], now["max"]), (change["now"].get("class") or "unnamed") + " moved here"))
    return events


def last_visit(folder):
    return max(int(row["visit"]) for row in csv.DictReader(open(f"{folder}/visits.csv")))


def true_events(folder, visits):
    """Events of some visits that the visit and the one before could see, and those that one of them could not."""
    clear, unclear = [], []
    for row in csv.DictReader(open(f"{folder}/events.csv")):
        if row["event"] == "hidden" or int(row["visit"]) not in visits:
            continue
        sides = []
        if row["xmin"]:
            sides.append(("gone", box_of(row), row["instance"], ""))
        if row["new_xmin"]:
            sides.append(("new", box_of(row, "new_"), row["new_instance"], "new_"))
        for kind, box, instance, prefix in sides:
            points = [int(row[f"{prefix}points_{when}"]) for when in ("before", "after")]
            target = clear if min(points) >= MIN_SEEN else unclear
            target.append((kind, box, f"{row['class']} {row['event']} {instance}"))
    return clear, unclear


def score_events(changes, folder, listing):
    """The counts, and the boxes of what is reported to be gone and matches no true event."""
    reported = reported_events(changes)
    last = last_visit(folder)
    clear, unclear = true_events(folder, [last])
    left, right = match(reported, clear)
    rest = [event for i, event in enumerate(reported) if i not in left]
    of_unclear = match(rest, unclear)[0]
    rest = [event for i, event in enumerate(rest) if i not in of_unclear]
    true = clear + unclear
    pieces = [e for e in rest if any(e[0] == other[0] and lies_within(e[1], other[1]) for other in true)]
    false = [event for event in rest if event not in pieces]
    if listing:
        for event in false:
            print("false ", event, file=sys.stderr)
        for j, event in enumerate(clear):
            if j not in right:
                print("missed", event, file=sys.stderr)
    earlier = sum(true_events(folder, range(1, last)), [])
    stale = match(false, earlier)[0]
    scores = {"stale": len(stale), "true": len(left), "pieces": len(pieces), "false": len(false), "missed": len(clear) - len(right), "unclear": len(unclear)}
    return scores, [box for kind, box, _ in rest if kind == "gone"]


def score_states(changes, gone, seen, boxes, present, cut, hidden):
    """The table of states, and how many unobserved objects a report says to be gone. Things that a van hides have rows
    of their own, too."""
    wholes, parts = (
        [(s["class"], (s["box_m"]["min"], s["box_m"]["max"]), s["after"]) for s in changes.get(key, [])]
        for key in ("states", "parts")
    )
    table, vanished = {}, 0
    last = str(max(int(visit) for _, visit in seen))
    for instance, box in boxes.items():
        if (instance, last) not in seen:
            continue
        states = wholes + [part for part in parts if overlap(part[1], box) >= 0.5]
        best = max(states, key=lambda state: overlap(state[1], box), default=None)
        if best is None or overlap(best[1], box) < 0.2:
            continue
        share = seen[instance, last]
        if NOT_SEEN <= share < MIN_SEEN:
            continue
        truth = "not observed" if share < NOT_SEEN else "present" if present[instance, last] else "absent"
        if truth == "present" and instance in cut:
            truth = "cut"
        if truth == "not observed":
            is_gone = any(overlap(other, box) >= 0.2 or (overlap(other, box) > 0 and holds_centre(other, box)) for other in gone)
            vanished += 1 if is_gone or best[2] == "absent" else 0
        for row in (truth, truth + " behind a van")[: 2 if instance in hidden else 1]:
            table[row, best[2]] = table.get((row, best[2]), 0) + 1
    return table, vanished


def dynamic_instances(folder):
    """By visit (0: earlier scans): instances with dynamic points, those of them whose event counts, and those left out."""
    dynamic, counting, left_out = (set(), set()), (set(), set()), set()
    for row in csv.DictReader(open(f"{folder}/events.csv")):
        if row["event"] == "hidden":
            continue
        for visit, prefix in ((0, ""), (1, "new_")):
            if not row[prefix + "xmin"]:
                continue
            instance = row[prefix + "instance"]
            if row["event"] in ("cut", "replaced"):
                left_out.add(instance)
                continue
            dynamic[visit].add(instance)
            if min(int(row[f"{prefix}points_{when}"]) for when in ("before", "after")) >= MIN_SEEN:
                counting[visit].add(instance)
    return dynamic, counting, left_out


def score_points(changes, folder, points_file):
    """Counts of points: static, static that are kept, dynamic, dynamic that were found, and the same of counting events."""
    reported = {}
    for row in csv.DictReader(open(points_file, newline="")):
        name = os.path.splitext(os.path.basename(row["source"]))[0]
        reported.setdefault(name, set()).add(int(row["point"]))
    scans = os.path.dirname(os.path.abspath(folder))
    names = sorted(os.path.splitext(file)[0] for file in os.listdir(scans) if file.endswith(".pcd"))
    times = [float(line) for line in open(f"{scans}/times.txt") if line.strip() and not line.startswith("#")]
    since = datetime.datetime.fromisoformat(changes["since"].replace("Z", "+00:00")).timestamp()
    dynamic, counting, left_out = dynamic_instances(folder)
    counts = dict.fromkeys(("static", "kept", "dynamic", "found", "counting", "counting_found"), 0)
    for name, time in zip(names, times, strict=True):
        visit, marked = int(time >= since), reported.get(name, set())
        for point, line in enumerate(gzip.open(f"{folder}/{name}.truth.gz", "rt")):
            instance = line.rsplit(None, 1)[1]
            if instance in left_out:
                continue
            is_marked = point in marked
            if instance not in dynamic[visit]:
                counts["static"] += 1
                counts["kept"] += not is_marked
                continue
            counts["dynamic"] += 1
            counts["found"] += is_marked
            if instance in counting[visit]:
                counts["counting"] += 1
                counts["counting_found"] += is_marked
    return counts


def print_points(points):
    static = points["kept"] / points["static"]
    print("\n| points of | dynamic | static accuracy | dynamic accuracy | associated accuracy |\n|---|---|---|---|---|")
    for name, all_points, found in (("all events", "dynamic", "found"), ("events that count", "counting", "counting_found")):
        share = points[found] / points[all_points]
        print(f"| {name} | {points[all_points]} | {static:.4f} | {share:.4f} | {math.sqrt(static * share):.4f} |")


def sum_up(files):
    """One table over several campuses."""
    events, states, points = {}, {}, {}
    for file in files:
        scores = json.load(open(file))
        for total, part in ((events, scores["events"]), (states, scores["states"]), (points, scores.get("points", {}))):
            for key, count in part.items():
                total[key] = total.get(key, 0) + count
    true, false, missed = (events[key] for key in ("true", "false", "missed"))
    print(f"| campuses | {len(files)} |\n|---|---|")
    print(f"| events found, false, missed | {true}, {false}, {missed} |")
    if events.get("stale"):
        print(f"| false ones that are events of earlier visits | {events['stale']} |")
    print(f"| pieces of true events; events too little seen | {events['pieces']}; {events['unclear']} |")
    print(f"| precision, recall | {true / (true + false):.3f}, {true / (true + missed):.3f} |")
    print(f"| F1 | {2 * true / (2 * true + false + missed):.3f} |")
    names = ("present", "absent", "not observed")
    unobserved = sum(states.get(f"not observed -> {name}", 0) for name in names)
    print(f"| objects not observed; of them called gone | {unobserved}; {events['vanished']} |")
    print("\n| truth \\ reported | " + " | ".join(names) + " |\n|---|---|---|---|")
    for truth in names + ("cut",) + tuple(f"{name} behind a van" for name in names):
        print(f"| {truth} | " + " | ".join(str(states.get(f"{truth} -> {name}", 0)) for name in names) + " |")
    if points:
        print_points(points)


def main():
    if sys.argv[1] == "--sum":
        return sum_up(sys.argv[2:])
    changes = json.load(open(sys.argv[1]))
    folder = sys.argv[2]
    seen, present, boxes = {}, {}, {}
    for row in csv.DictReader(open(f"{folder}/visits.csv")):
        key = row["instance"], row["visit"]
        seen[key], present[key] = int(row["points"]), row["present"] == "1"
    for row in csv.DictReader(open(f"{folder}/instances.csv")):
        boxes[row["id"]] = box_of(row)
    events, gone = score_events(changes, folder, "--list" in sys.argv)
    cut, hidden = set(), set()
    for row in csv.DictReader(open(f"{folder}/events.csv")):
        if row["event"] == "cut":
            cut.add(row["instance"])
        if row["event"] == "hidden":
            hidden.add(row["instance"])
        if row["event"] == "replaced":
            boxes.pop(row["instance"], None)
            boxes.pop(row["new_instance"], None)
    states, events["vanished"] = score_states(changes, gone, seen, boxes, present, cut, hidden)
    scores = {"events": events, "states": {f"{t} -> {r}": n for (t, r), n in sorted(states.items())}}
    if "--points" in sys.argv:
        scores["points"] = score_points(changes, folder, sys.argv[sys.argv.index("--points") + 1])
    print(json.dumps(scores))


if __name__ == "__main__":
    main()
