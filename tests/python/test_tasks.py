# SPDX-License-Identifier: Apache-2.0
"""Tasks of the module, compared with those of the program."""
import json
import os
import subprocess

import numpy as np
import pytest

import cluxel
from conftest import run


def test_an_inventory_is_that_of_the_program(campus_map):
    found = campus_map.inventory()
    rows = json.loads(run("inventory", campus_map.file, "--json"))["rows"]
    assert len(found.items) == len(rows) > 5
    for item, row in zip(found.items, rows):
        assert (item.kind, item.object) == (row["kind"], row.get("object"))
        np.testing.assert_allclose(item.at, (row["x"], row["y"]), atol=1e-3)
        for ours, theirs in ((item.height_m, "height"), (item.crown_m, "crown"), (item.width_m, "width"),
                             (item.length_m, "length"), (item.vehicle_count, "count")):
            assert (ours is None) == (row.get(theirs) is None)
            assert ours is None or ours == pytest.approx(row[theirs], abs=1e-3)
        assert item.line.shape == (len(item.line), 2) and item.street is None
    trees = campus_map.inventory("Tree").items
    assert {item.kind for item in trees} == {"Tree"} and len(trees) == len(campus_map.inventory(["Tree"]).items)
    with pytest.raises(cluxel.NotFoundError, match="did you mean 'Tree'"):
        campus_map.inventory(["Tre"])


def test_a_search_is_that_of_the_program(campus_map):
    found = campus_map.search("StreetSign", without="Movable", budget_m=60, max_stops=4)
    told = json.loads(run("search", campus_map.file, "--for", "StreetSign", "--without", "Movable", "--budget", 60,
                          "--stops", 4, "--json"))
    assert len(found.stops) == len(told["stops"]) > 0
    for stop, row in zip(found.stops, told["stops"]):
        np.testing.assert_array_equal(stop.at, row["at"])
        np.testing.assert_allclose((stop.walk_m, stop.total_m, stop.probability, stop.so_far),
                                   [row[name] for name in ("walk", "total", "probability", "soFar")], atol=1e-4)
        assert stop.near_class == row["near"] and stop.way.shape == (len(stop.way), 2)
        np.testing.assert_array_equal(stop.way[-1], stop.at)
    assert [known.iri for known in found.known] == [known["object"] for known in told["known"]]
    assert {known.iri for known in found.known} == {sign.iri for sign in campus_map.objects("StreetSign")}


def test_a_search_starts_where_it_is_told(campus_map):
    sensor = campus_map.clouds()[-1].T_map_sensor[:2, 3]
    stops = [campus_map.search("StreetSign", start=start, max_stops=1).stops[0].at.tolist()
             for start in (sensor, tuple(sensor), sensor.tolist(), "%r,%r" % tuple(sensor.tolist()))]
    assert stops.count(stops[0]) == 4
    tree = campus_map.objects("Tree")[0]
    known = [campus_map.search("Tree", start=start, max_stops=1, without="Tree").known[0]
             for start in (tree, tree.number, tree.iri)]
    assert {(one.iri, one.distance_m) for one in known} == {(tree.iri, 0.0)}


@pytest.mark.parametrize("options", [{"start": (float("nan"), 0.0)}, {"width_m": -1}, {"cell_m": 0.3}, {"max_stops": 0},
                                     {"budget_m": 0}, {"start": ""}])
def test_walks_that_cannot_be_are_refused(campus_map, options):
    with pytest.raises(cluxel.InvalidArgumentError):
        campus_map.search("Tree", **options)


def told_route(campus_map, start, goal, *options):
    """The answer of the program as JSON; its exit code is 1 where no way leads there."""
    words = [os.environ["CLUXEL_PROGRAM"], "route", campus_map.file, start, goal, *map(str, options), "--json"]
    return json.loads(subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout)


def test_routes_and_barriers_are_those_of_the_program(campus_map):
    clouds = campus_map.clouds()
    places = [tuple(cloud.T_map_sensor[:2, 3].tolist()) for cloud in clouds[:2]]
    texts = ["%r,%r" % place for place in places]
    found = campus_map.routes(*places, near="Tree", alternatives=3, without=["Movable"], width_m=0.5)
    told = told_route(campus_map, *texts, "--near", "Tree", "--alternatives", 3, "--without", "Movable", "--width", 0.5)
    assert found and len(found.routes) == len(told["routes"]) and not found.barriers
    for route, row in zip(found.routes, told["routes"]):
        np.testing.assert_array_equal(route.line, row["places"])
        for ours, theirs in ((route.length_m, "length"), (route.cost, "cost"), (route.climb_m, "climb"),
                             (route.steepest, "steepest"), (route.highest_step_m, "highestStep"),
                             (route.narrowest_m, "narrowest")):
            assert (None if ours is None else pytest.approx(ours, abs=1e-3)) == row.get(theirs)
    # The ground on the other side of kerbs that may not be crossed.
    cells = campus_map.cost_map()
    goals = np.argwhere(cells.cells == cluxel.GROUND_KINDS.index("free"))[::97]
    for row, column in goals:
        goal = tuple((cells.origin + cells.cell_m * (np.array([column, row]) + 0.5)).tolist())
        try:
            closed = campus_map.routes(places[0], goal, max_step_m=0.02)
        except cluxel.NotFoundError:
            continue
        if not closed:
            break
    told = told_route(campus_map, texts[0], "%r,%r" % goal, "--max-step", 0.02)
    assert not closed and len(closed.barriers) == len(told["barriers"]) > 0
    for barrier, row in zip(closed.barriers, told["barriers"]):
        assert (barrier.kind, barrier.text, barrier.object) == (row["kind"], row["text"], row.get("object"))
        np.testing.assert_allclose((*barrier.at, barrier.length_m), (*row["at"], row["length"]), atol=1e-3)
        assert (None if barrier.measured is None else pytest.approx(barrier.measured, abs=1e-3)) == row.get("measured")


def test_a_cost_map_is_the_image_of_the_program(campus_map, tmp_path):
    run("costmap", campus_map.file, "-o", tmp_path / "ground.pgm", "--cell", 0.5, "--max-step", 0.1)
    found = campus_map.cost_map(cell_m=0.5, max_step_m=0.1)
    form, shape, most, pixels = (tmp_path / "ground.pgm").read_bytes().split(b"\n", 3)
    columns, rows = map(int, shape.split())
    assert found.cells.dtype == np.uint8 and found.cells.shape == (rows, columns)
    grey = {"free": 254, "unobserved": 205}
    greys = np.array([grey.get(kind, 0) for kind in cluxel.GROUND_KINDS], dtype=np.uint8)
    np.testing.assert_array_equal(greys[found.cells[::-1]], np.frombuffer(pixels, np.uint8).reshape(rows, columns))
    yaml = (tmp_path / "ground.yaml").read_text()
    assert "resolution: %g\n" % found.cell_m in yaml and "origin: [%.3f, %.3f, 0.0]" % tuple(found.origin) in yaml
    assert len(np.unique(found.cells)) >= 3
