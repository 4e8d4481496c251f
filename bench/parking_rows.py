#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the parking rows of maps of generated campuses with where their cars stand.

parking_rows.py CLUXEL FOLDER SEED...: simulates and builds one campus a seed in FOLDER, which is made, and prints a table. The cars of
one side of the street with middles at most 9 m apart are a true row when they are three or more and the scans saw them.
"""
import csv
import io
import json
import math
import subprocess
import sys
from pathlib import Path

ROWS = """PREFIX clx: <https://w3id.org/cluxel/ontology#>
SELECT ?row ?x ?y { ?row a clx:ParkingRow ; clx:hasMember ?vehicle . ?vehicle clx:x ?x ; clx:y ?y }"""
VEHICLES = "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?x ?y { ?vehicle a clx:Vehicle ; clx:x ?x ; clx:y ?y }"
GAP_M, SAME_M, LEAST = 9.0, 2.5, 3


def asked(cluxel, campus, query):
    """The rows of a question; none is no fault (exit code 3)."""
    done = subprocess.run([cluxel, "query", str(campus), "-e", query, "--format", "csv"], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(done.stderr)
    return list(csv.DictReader(io.StringIO(done.stdout)))


def nearest(place, cars):
    """The number of the true car at a place, or None."""
    number = min(range(len(cars)), key=lambda i: math.dist(cars[i], place), default=None)
    return number if number is not None and math.dist(cars[number], place) <= SAME_M else None


def true_rows(cars, heading):
    """Sets of numbers of cars: along one side of the street, each at most GAP_M from the next."""
    turned = [(x * math.cos(heading) + y * math.sin(heading), y * math.cos(heading) - x * math.sin(heading)) for x, y in cars]
    rows = []
    for number in sorted(range(len(cars)), key=lambda i: turned[i]):
        along, across = turned[number]
        joined = [row for row in rows if any(abs(turned[i][0] - along) <= GAP_M and abs(turned[i][1] - across) <= 1.5 for i in row)]
        rows = [row for row in rows if row not in joined] + [set().union({number}, *joined)]
    return [row for row in rows if len(row) >= LEAST]


def measured(cluxel, folder, seed):
    scans, campus = folder / f"scans{seed}", folder / f"map{seed}.clx"
    subprocess.run([cluxel, "simulate", str(scans), "--seed", str(seed), "--stops", "6", "--size", "80",
                    "--points-per-stop", "60000"], check=True, capture_output=True)
    subprocess.run([cluxel, "build", str(scans), "-o", str(campus), "--force"], check=True, capture_output=True)
    truth = json.loads((scans / "campus.json").read_text())
    cars = [tuple(o["position_m"][:2]) for o in truth["objects"] if o.get("class") == "Vehicle" and "cycle" not in o["kind"]]
    seen = {nearest((float(v["x"]), float(v["y"])), cars) for v in asked(cluxel, campus, VEHICLES)} - {None}
    seen_cars = [cars[i] for i in sorted(seen)]
    rows = true_rows(seen_cars, truth["heading_rad"])
    found = {}
    for vehicle in asked(cluxel, campus, ROWS):
        found.setdefault(vehicle["row"], []).append(nearest((float(vehicle["x"]), float(vehicle["y"])), seen_cars))
    whole = sum(any(set(members) == row for members in found.values()) for row in rows)
    mixed = sum(not any(set(members) <= row for row in rows) for members in found.values())
    errors = [min((abs(len(row) - len(members)) for members in found.values() if set(members) & row), default=len(row))
              for row in rows]
    return len(cars), len(seen_cars), len(rows), len(found), whole, mixed, errors


def main():
    cluxel, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True)
    print("| seed | cars | in the map | true rows | found rows | found whole | found with others |\n|---|---|---|---|---|---|---|")
    errors, sums = [], [0] * 6
    for seed in sys.argv[3:]:
        *counts, of_rows = measured(cluxel, folder, int(seed))
        errors += of_rows
        sums = [a + b for a, b in zip(sums, counts)]
        print(f"| {seed} | " + " | ".join(map(str, counts)) + " |")
    print("| all | " + " | ".join(map(str, sums)) + " |")
    errors.sort()
    if errors:
        print(f"\nvehicles of a row, error: median {errors[len(errors) // 2]}, worst {errors[-1]}")


main()
