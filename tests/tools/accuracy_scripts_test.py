#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# The scripts behind bench/accuracy.sh: leaving out the border of a place, and adding up evaluations.
import gzip
import json
import os
import random
import subprocess
import sys
import tempfile

BENCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../bench")


def run(script, *words):
    return subprocess.run([sys.executable, f"{BENCH}/{script}", *words], check=True, capture_output=True, text=True).stdout


def write_chunk(data, name, points, truth):
    with open(f"{data}/oakland3d/oakland_part2_{name}.xyz_label_conf", "w") as file:
        file.write("# x y z label confidence\n" + "".join(f"{x} {y} 0 1200 0\n" for x, y in points))
    with gzip.open(f"{data}/oakland3d_truth/oakland_part2_{name}.truth.gz", "wt") as file:
        file.writelines("%d %d %d\n" % row for row in truth)


def border_is_left_out(folder):
    """Compared with all distances: what is nearer than 10 m is out, what is farther than 13 m (two cells) stays."""
    data, seeded = f"{folder}/data", random.Random(7)
    for name in ("oakland3d", "oakland3d_truth"):
        os.makedirs(f"{data}/{name}")
    held = [(seeded.uniform(-20, 0), seeded.uniform(-20, 20)) for _ in range(60)]
    rest = [(seeded.uniform(-5, 40), seeded.uniform(-30, 30)) for _ in range(400)]
    crossing = 5   # a tree with points in both chunks
    write_chunk(data, "aa", held, [(4, 2, crossing)] + [(0, 0, 0)] * 59)
    rest_truth = [(4, 2, crossing)] * 10 + [(0, 0, 0)] * 200 + [(4, 2, 6)] * 190
    write_chunk(data, "ab", rest, rest_truth)
    run("leave_out_border.py", data, f"{folder}/truth", "aa")
    assert os.listdir(f"{folder}/truth") == ["oakland_part2_ab.truth"], "the held chunk has no truth"
    with open(f"{folder}/truth/oakland_part2_ab.truth") as file:
        left = [tuple(map(int, line.split())) for line in file]
    assert len(left) == len(rest)
    kept = near = 0
    for i, ((x, y), row) in enumerate(zip(rest, left)):
        distance = min(((x - a) ** 2 + (y - b) ** 2) ** 0.5 for a, b in held)
        assert row in ((-1, -1, -1), rest_truth[i])
        if distance <= 10 or i < 10:
            near += 1
            assert row == (-1, -1, -1), (i, distance)
        elif distance > 13:
            kept += 1
            assert row == rest_truth[i], (i, distance)
    assert kept > 50 and near > 50


def evaluation(hits, misses, false):
    """Trees: by point and by object `hits` are right, `misses` are bushes; `false` bushes are trees."""
    rows = [{"class": "Tree", "answers": {"Tree": hits, "Bush": misses}}, {"class": "Bush", "answers": {"Tree": false}}]
    scores = [{"class": "Tree", "truth": hits + misses, "answers": hits + false, "matched_truth": hits,
               "matched_answers": hits}]
    kinds = [{"kind": "trunk", "truth": hits + misses, "found": {"Tree": hits, "none": misses}, "called": {"Tree": hits}}]
    return {"primitives_by_point": {"classes": rows}, "objects_by_point": {"classes": rows}, "coverage": "all",
            "objects_by_point_set": scores, "objects_by_box": scores, "objects_by_kind": kinds}


def counts_are_added_before_shares(folder):
    for name, counts in (("a", (9, 1, 0)), ("b", (1, 9, 10))):
        with open(f"{folder}/{name}.json", "w") as file:
            json.dump(evaluation(*counts), file)
    text = run("accuracy_tables.py", f"{folder}/a.json", f"{folder}/b.json")
    assert "| Tree | 0.500 | 0.500 | 0.500 | 0.333 | 20 |" in text, text
    # Wilson's interval of 10 of 20.
    assert "| Tree | 0.500 (0.30 to 0.70) | 0.500 (0.30 to 0.70) | 0.500 (0.30 to 0.70) | 20 | 20 |" in text, text


def bars_are_judged(folder):
    os.makedirs(f"{folder}/out/sydney")
    some = evaluation(9, 1, 0) | {"coverage": "some"}
    some["objects_by_point_set"] = [{"class": name, "truth": 10, "answers": 10, "matched_truth": 8, "matched_answers": 8}
                                    for name in ("StreetSign", "Vehicle", "Person")]
    with open(f"{folder}/out/sydney/oakland.json", "w") as file:
        json.dump(some, file)
    text = run("accuracy_tables.py", f"{folder}/out")
    assert "traffic signs found | 0.800 (0.49 to 0.94) | 0.70 | yes |" in text, text
    assert "called signs (at most) | 0.000 (0.00 to 0.28) | 0.10 | yes |" in text, text
    assert "poles and trunks found as Pole or Tree | 0.900 (0.60 to 0.98) | 0.75 | yes |" in text, text
    assert "| trunk | 10 | Tree 9, none 1 | Tree 9 |" in text, text


for check in (border_is_left_out, counts_are_added_before_shares, bars_are_judged):
    with tempfile.TemporaryDirectory() as scratch:
        check(scratch)
