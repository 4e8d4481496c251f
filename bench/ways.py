#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the ways of maps of generated campuses with the street, walks and paths of their plans.

ways.py CLUXEL FOLDER SEED...: simulates and builds one campus a seed in FOLDER, which is made, and prints a table. The
middle lines of the plan are cut into pieces of 0.5 m. A piece within SEEN_M of a stop is expected in the map; it is found
when a way passes it within NEAR_M, turned by at most TURN_RAD. In the same manner a piece of a way is true when a line of
the plan passes it. The error of a width is counted once for each found piece.
"""
import csv
import io
import json
import math
import re
import subprocess
import sys
from pathlib import Path

WAYS = """PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX geo: <http://www.opengis.net/ont/geosparql#>
SELECT ?way ?line ?width (GROUP_CONCAT(?class) AS ?kinds) {
  ?way a clx:Way ; a ?class ; clx:width ?width ; geo:hasGeometry/geo:asWKT ?line } GROUP BY ?way ?line ?width ORDER BY ?way"""
STEP_M, SEEN_M, NEAR_M, TURN_RAD = 0.5, 12.0, 1.0, 0.35
KINDS = ("street", "walk", "path")
# Of the generator: widths, and where a plan's lines lie. src/simulation/site/site_plan.hpp has the same numbers.
WIDTH = {"street": 8.0, "walk": 2.35, "path": 2.6, "winding path": 2.08}


def plan_lines(size, heading):
    """Lines of the plan in the map frame, as (kind, points)."""
    street, south = -0.22 * size, -0.22 * size + 5.8
    west, east, north = -0.32 * size, 0.32 * size, 0.2 * size
    half = size / 2
    middle, swing = 0.5 * (south + north), 0.18 * (north - south)
    winding = [(x, middle + swing * math.sin(2 * math.pi * x / (east - west)))
               for x in [west + i * (east - west) / 200 for i in range(201)]]
    lines = [("street", [(-half, street), (half, street)]),
             ("walk", [(-half, street + 5.325), (half, street + 5.325)]),
             ("walk", [(-half, street - 5.325), (half, street - 5.325)]),
             ("path", [(west, street + 6.5), (west, north)]), ("path", [(east, street + 6.5), (east, north)]),
             ("path", [(west, north), (east, north)]), ("path", [(0, north), (0, north + 8)]), ("winding path", winding)]
    c, s = math.cos(heading), math.sin(heading)
    return [(kind, [(c * x - s * y, s * x + c * y) for x, y in points]) for kind, points in lines]


def pieces(points):
    """(x, y, direction) every STEP_M along a line."""
    cut = []
    for a, b in zip(points, points[1:]):
        length = math.dist(a, b)
        count = max(1, round(length / STEP_M))
        direction = math.atan2(b[1] - a[1], b[0] - a[0])
        cut += [(a[0] + (b[0] - a[0]) * (i + 0.5) / count, a[1] + (b[1] - a[1]) * (i + 0.5) / count, direction, length / count)
                for i in range(count)]
    return cut


def nearest(piece, others):
    """The nearest of other pieces, as (x, y, direction, length, ...), that lies beside this one; or None."""
    best = None
    for other in others:
        distance = math.dist(piece[:2], other[:2])
        turn = abs((piece[2] - other[2] + math.pi / 2) % math.pi - math.pi / 2)
        if distance <= NEAR_M and turn <= TURN_RAD and (best is None or distance < best[0]):
            best = distance, other
    return best and best[1]


def asked(cluxel, campus):
    done = subprocess.run([cluxel, "query", str(campus), "-e", WAYS, "--format", "csv"], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(done.stderr)
    return list(csv.DictReader(io.StringIO(done.stdout)))


def measured(cluxel, folder, seed):
    scans, campus = folder / f"scans{seed}", folder / f"map{seed}.clx"
    if not scans.exists():
        subprocess.run([cluxel, "simulate", str(scans), "--seed", str(seed), "--stops", "12", "--size", "80",
                        "--points-per-stop", "100000"], check=True, capture_output=True)
    subprocess.run([cluxel, "build", str(scans), "-o", str(campus), "--force"], check=True, capture_output=True)
    truth = json.loads((scans / "campus.json").read_text())
    stops = [stop[:2] for stop in truth["stops_m"]]
    plan = [piece + (kind,) for kind, points in plan_lines(truth["parameters"]["size"], truth["heading_rad"])
            for piece in pieces(points)]
    ways = []
    for way in asked(cluxel, campus):
        points = [tuple(map(float, p.split())) for p in re.search(r"\((.*)\)", way["line"])[1].split(",")]
        ways += [piece + (float(way["width"]), way["kinds"]) for piece in pieces(points)]
    expected = [piece for piece in plan if min(math.dist(piece[:2], stop) for stop in stops) <= SEEN_M]
    rows = {kind: [0.0, 0.0, []] for kind in KINDS}
    for piece in expected:
        row = rows[piece[4].split()[-1]]
        row[0] += piece[3]
        if (way := nearest(piece, ways)):
            row[1] += piece[3]
            row[2].append(abs(way[4] - WIDTH[piece[4]]))
    length = sum(piece[3] for piece in ways)
    true = sum(piece[3] for piece in ways if nearest(piece, plan))
    sidewalks = [piece for piece in ways if "Sidewalk" in piece[5]]
    on_walks = [piece for piece in sidewalks if (line := nearest(piece, plan)) and line[4] == "walk"]
    return rows, length, true, (sum(p[3] for p in sidewalks), sum(p[3] for p in on_walks),
                                [abs(p[4] - WIDTH["walk"]) for p in on_walks])


def median(errors):
    return f"{sorted(errors)[len(errors) // 2]:.2f}" if errors else "–"


def main():
    cluxel, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    print("| seed | street | found | walks | found | paths | found | ways | true | error of widths: street | walks | paths |")
    print("|---" * 12 + "|")
    sums, lengths, sidewalks = {kind: [0.0, 0.0, []] for kind in KINDS}, [0.0, 0.0], [0.0, 0.0, []]

    def row(name, rows, length, true):
        print(f"| {name} | " + " | ".join(f"{rows[kind][0]:.0f} m | {rows[kind][1]:.0f} m" for kind in KINDS) +
              f" | {length:.0f} m | {true:.0f} m | " + " | ".join(median(rows[kind][2]) for kind in KINDS) + " |", flush=True)

    for seed in sys.argv[3:]:
        rows, length, true, of_class = measured(cluxel, folder, int(seed))
        sidewalks = [a + b for a, b in zip(sidewalks, of_class)]
        row(seed, rows, length, true)
        lengths = [lengths[0] + length, lengths[1] + true]
        for kind in KINDS:
            sums[kind] = [a + b for a, b in zip(sums[kind], rows[kind])]
    row("all", sums, *lengths)
    for kind in KINDS:
        if sums[kind][2]:
            print(f"\nworst error of the width of a {kind}: {max(sums[kind][2]):.2f} m")
    print(f"\nclx:Sidewalk: {sidewalks[0]:.0f} m, of which {sidewalks[1]:.0f} m on walks; error of their widths: median "
          f"{median(sidewalks[2])} m, worst {max(sidewalks[2], default=0):.2f} m")


main()
