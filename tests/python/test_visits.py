# SPDX-License-Identifier: Apache-2.0
"""Changes between visits, compared with those of the program."""
import csv
import json

import numpy as np
import pytest

import cluxel
from conftest import run


@pytest.fixture(scope="module")
def visited(campus, tmp_path_factory):
    folder = tmp_path_factory.mktemp("visited")
    campus_of_two_visits = ["--seed", 7, "--stops", 3, "--size", 50, "--points-per-stop", 20000, "--visits", 2]
    run("simulate", folder / "scans", *campus_of_two_visits)
    return campus.build(folder / "visited.clx", folder / "scans")


def same_thing(thing, row):
    np.testing.assert_allclose(thing.box, [row["box_m"]["min"], row["box_m"]["max"]], atol=1e-3)
    assert (thing.object, thing.class_name, thing.is_part, thing.cluxel_count) == (
        row["object"], row["class"], row["part"], row["cluxels"])


def test_changes_and_states_are_those_of_the_program(visited):
    found = visited.changes()
    told = json.loads(run("changes", visited.file, "--json"))
    assert len(found.changes) == len(told["changes"]) > 0 and found.points is None and found.until_s is None
    for change, row in zip(found.changes, told["changes"]):
        assert change.kind == row["change"]
        same_thing(change.thing, row)
        assert (change.now is not None) == (change.distance_m is not None) == ("now" in row)
        if change.now is not None:
            same_thing(change.now, row["now"])
            assert change.distance_m == pytest.approx(row["distance"], abs=1e-3)
    assert len(found.states) == len(told["states"]) > 10 and len(found.parts) == len(told["parts"])
    for states, row in zip(found.states, told["states"]):
        assert (states.iri, states.number, states.class_name, states.before, states.after) == (
            row["object"], row["number"], row["class"], row["before"], row["after"])
        np.testing.assert_allclose(states.box, [row["box_m"]["min"], row["box_m"]["max"]], atol=1e-3)
        for name in ("log_odds_before", "log_odds_after", "coverage_before", "coverage_after"):
            assert getattr(states, name) == pytest.approx(row[name], abs=0.0051)
    for part, row in zip(found.parts, told["parts"]):
        assert (part.part.object, part.before, part.after) == (row["object"], row["before"], row["after"])
    assert {states.after for states in found.states} > {"absent"}
    assert {change.kind for change in found.changes} == {"vanished", "appeared", "moved"} and len(found.parts) > 0


def test_points_are_those_of_the_program(visited, tmp_path):
    points = visited.changes(with_points=True).points
    run("changes", visited.file, "--points", tmp_path / "points.csv")
    with open(tmp_path / "points.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(points) == len(rows) > 0 and points.is_gone.dtype == bool
    assert [points.cloud_ids[cloud] for cloud in points.cloud] == [row["cloud"] for row in rows]
    assert points.point.tolist() == [int(row["point"]) for row in rows]
    assert points.change.tolist() == [int(row["change"]) for row in rows]
    assert ["vanished" if gone else "appeared" for gone in points.is_gone] == [row["kind"] for row in rows]


def test_times_are_numbers_or_texts(visited, campus_map):
    times = sorted(cloud.time_s for cloud in visited.clouds())
    since = times[len(times) // 2]
    assert visited.changes(since=since).since_s == visited.changes().since_s == since
    told = visited.changes(since="%r" % since, until=times[-1])
    assert (told.since_s, told.until_s) == (since, times[-1])
    with pytest.raises(cluxel.InvalidArgumentError, match="'yesterday' is no time"):
        visited.changes(since="yesterday")
    with pytest.raises(cluxel.InvalidArgumentError) as raised:
        campus_map.changes()
    assert "since=TIME" in raised.value.remedy
