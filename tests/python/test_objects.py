# SPDX-License-Identifier: Apache-2.0
"""Objects, points, scans and explanations, compared with queries and with the program."""
import json

import numpy as np
import pytest

import cluxel
from conftest import PREFIX, run


def test_objects_are_those_of_a_query(campus_map):
    things = campus_map.objects()
    answer = campus_map.query(PREFIX + (
        "SELECT ?o ?x ?y ?z ?minX ?maxZ ?height ?heading ?confidence ?n ?rule { GRAPH <https://w3id.org/cluxel/graph/observed> "
        "{ ?o clx:heading ?heading ; clx:x ?x ; clx:y ?y ; clx:z ?z ; clx:minX ?minX ; clx:maxZ ?maxZ ; clx:height ?height ; "
        "clx:confidence ?confidence ; clx:pointCount ?n ; clx:rule ?rule } } ORDER BY ?o"))
    assert [thing.iri for thing in things] == answer["o"] and len(things) > 5
    assert [thing.number for thing in things] == list(range(len(things)))
    np.testing.assert_array_equal([thing.centroid for thing in things], np.stack([answer[axis] for axis in "xyz"], axis=1))
    np.testing.assert_array_equal([thing.box[0, 0] for thing in things], answer["minX"])
    np.testing.assert_array_equal([thing.box[1, 2] for thing in things], answer["maxZ"])
    for column, attribute in (("height", "height_m"), ("heading", "heading_rad"), ("confidence", "confidence"), ("n", "point_count")):
        np.testing.assert_array_equal([getattr(thing, attribute) for thing in things], answer[column])
    assert [thing.rule for thing in things] == answer["rule"]


def test_objects_tell_when_they_were_there(campus, tmp_path):
    run("simulate", tmp_path / "scans", "--seed", 5, "--stops", 2, "--size", 50, "--points-per-stop", 15000, "--visits", 2)
    visited = campus.build(tmp_path / "visited.clx", tmp_path / "scans")
    answer = visited.query(PREFIX + (
        "SELECT ?o ?first ?last ?through { ?o clx:confidence ?c OPTIONAL { ?o clx:firstSeen ?first ; clx:lastSeen ?last } "
        "OPTIONAL { ?o clx:seenThrough ?through } } ORDER BY ?o"))
    things = visited.objects()
    assert [thing.iri for thing in things] == answer.texts("o")
    for column, attribute in (("first", "first_seen"), ("last", "last_seen"), ("through", "seen_through")):
        assert [getattr(thing, attribute) for thing in things] == answer.texts(column)
    gone = [thing for thing in things if thing.seen_through is not None]
    assert 0 < len(gone) < len(things) and all(thing.last_seen < thing.seen_through for thing in gone)
    assert all(thing.first_seen is None for thing in visited.objects("Ground"))


def test_objects_are_chosen_by_class(campus_map):
    trees = campus_map.objects("Tree")
    assert len(trees) == campus_map.summary().objects_by_class["Tree"] > 0
    assert {tree.label for tree in trees} == {"tree"} and all(tree.class_iri.endswith("#Tree") for tree in trees)
    assert {tree.iri for tree in trees} <= {plant.iri for plant in campus_map.objects("clx:Plant")}
    parts = [part for tree in trees for part in tree.parts]
    assert parts and {part.label for part in parts} <= {"tree trunk", "tree top"}
    with pytest.raises(cluxel.NotFoundError, match="did you mean 'Tree'"):
        campus_map.objects("Tre")


def test_points_of_an_object_are_those_of_the_scans_that_belong_to_it(campus_map):
    tree = campus_map.objects("Tree")[0]
    points = campus_map.points(tree)
    assert points.xyz.dtype == np.float64 and points.xyz.shape == (len(points), 3)
    assert points.intensity.dtype == np.float32 and points.label.dtype == np.uint8 and points.object.dtype == np.int32
    assert {len(points.intensity), len(points.label), len(points.object)} == {len(points)}
    assert (points.object == tree.number).all()
    of_scans = [campus_map.points(cloud) for cloud in campus_map.clouds()]
    expected = np.concatenate([scan.xyz[scan.object == tree.number] for scan in of_scans])
    np.testing.assert_array_equal(points.xyz, expected)
    np.testing.assert_allclose(points.xyz.min(axis=0), tree.box[0], atol=0.1)  # thinning may drop the outermost points
    np.testing.assert_allclose(points.xyz.max(axis=0), tree.box[1], atol=0.1)
    np.testing.assert_array_equal(campus_map.points(tree.iri).xyz, points.xyz)


def test_points_are_named_as_explanations_are(copied_map):
    tree = copied_map.objects("Tree")[0]
    digits = tree.iri.rsplit("/", 1)[1]
    expected = copied_map.points(tree).xyz
    for name in (tree.number, f"#{tree.number}", tree.iri, f"<{tree.iri}>", f"map:object/{digits}", f"object/{digits}",
                 digits):
        assert np.array_equal(copied_map.points(name).xyz, expected), name
    for name in ("#100000", "https://w3id.org/cluxel/map/object/" + 32 * "0"):
        with pytest.raises(cluxel.NotFoundError):
            copied_map.points(name)
    run("state", copied_map.file, "--object", tree.iri, "--is", "StreetLamp")  # which gives it another name
    assert tree.iri not in {thing.iri for thing in copied_map.objects()}
    assert np.array_equal(copied_map.points(tree.iri).xyz, expected) and len(copied_map.points(tree)) == len(expected)


def test_points_of_a_scan_are_whole_and_labelled(campus_map):
    assert cluxel.LABELS == ("horizontal_plane", "vertical_plane", "column", "small_structure", "scatter")
    clouds = campus_map.clouds()
    assert len(clouds) == 3 and sum(cloud.point_count for cloud in clouds) == campus_map.summary().points
    for cloud in clouds:
        points = campus_map.points(cloud)
        assert len(points) == cloud.point_count
        np.testing.assert_allclose(points.xyz.min(axis=0), cloud.box[0], atol=1e-6)
        np.testing.assert_allclose(points.xyz.max(axis=0), cloud.box[1], atol=1e-6)
        assert points.object.min() == -1 and points.object.max() < len(campus_map.objects())
        assert points.label.max() < len(cluxel.LABELS)
        ground = points.xyz[points.label == 0]
        assert len(ground) > 0.2 * len(points)


def test_scans_have_pose_time_and_source(campus):
    poses = {tuple(np.array(line.split(), float).round(6)) for line in (campus.scans / "poses.txt").read_text().splitlines()
             if not line.startswith("#")}
    for cloud in campus.map.clouds():
        assert cloud.has_pose and cloud.T_map_sensor.shape == (4, 4)
        assert tuple(cloud.T_map_sensor.ravel().round(6)) in poses
        assert campus.scans / cloud.source.split("/")[-1] in campus.scans.iterdir()
        assert cloud.time_s > 0 and len(cloud.id) == 32 and cloud.iri.endswith(cloud.id)


def test_arrays_belong_to_the_caller(campus_map):
    points = campus_map.points(campus_map.clouds()[0])
    first = points.xyz[0].copy()
    points.xyz[0] = 0
    points.label[:] = 0
    assert (campus_map.points(campus_map.clouds()[0]).xyz[0] == first).all()
    xyz = points.xyz
    del points
    assert xyz[1:].any()


def test_explanations_are_those_of_the_program(campus, campus_map):
    thing = campus_map.objects("Tree")[0]
    expected = json.loads(run("explain", campus.file, thing.iri, "--json"))
    assert campus_map.explain(thing) == campus_map.explain(thing.iri) == campus_map.explain(thing.number) == expected
    assert campus_map.explain_text(thing) == run("explain", campus.file, thing.iri)
    with pytest.raises(cluxel.NotFoundError):
        campus_map.explain("zzzzzzzz")


def test_the_summary_counts(campus_map):
    summary = campus_map.summary()
    assert summary.is_finished and summary.clouds == 3 and summary.objects == len(campus_map.objects())
    assert sum(summary.objects_by_class.values()) == summary.objects
    (count,) = campus_map.query("SELECT (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } }")["n"]
    assert 0 < count <= summary.quads


def test_an_update_is_seen_by_all_readers(copied_map, campus_map):
    other = cluxel.open(copied_map.file)
    thing = other.objects()[0]
    assert len(other.points(thing)) > 0
    counts = copied_map.update('INSERT DATA { <%s> <http://example.org/name> "the first" }' % thing.iri)
    assert counts == (1, 0) and counts.inserted == 1
    for reader in (copied_map, other):
        assert reader.query('SELECT ?o { ?o <http://example.org/name> "the first" }')["o"] == [thing.iri]
    assert other.summary().quads > campus_map.summary().quads
    with pytest.raises(cluxel.FaultyInputError, match="LOAD"):
        copied_map.update("LOAD <http://example.org/x.ttl>")
