# SPDX-License-Identifier: Apache-2.0
"""Tasks of the module, compared with those of the program."""
import json

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
    told = json.loads(run("search", campus_map.file, "--for", "StreetSign", "--without", "Movable", "--budget", 60, "--stops", 4,
                          "--json"))
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
