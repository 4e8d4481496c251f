# SPDX-License-Identifier: Apache-2.0
"""Answers as columns, compared with what `cluxel query` prints."""
import csv
import io
import json
import math
import threading

import numpy as np
import pytest

import cluxel
from conftest import PREFIX, run

TABLE = PREFIX + (
    "SELECT ?o ?height ?points ?none ?part { ?o clx:rule ?rule ; clx:height ?height ; clx:pointCount ?points "
    "OPTIONAL { ?o clx:hasPart ?part } } ORDER BY ?o ?part"
)


def test_columns_are_those_of_the_program(campus, campus_map):
    answer = campus_map.query(TABLE)
    rows = list(csv.DictReader(io.StringIO(run("query", campus.file, "-e", TABLE, "--format", "csv"))))
    assert len(answer) == len(rows) > 5
    assert answer.kind == "solutions"
    assert answer.variables == list(answer.columns) == ["o", "height", "points", "none", "part"]
    assert answer["o"] == [row["o"] for row in rows]
    assert answer["height"].dtype == np.float64
    assert answer["height"].tolist() == [float(row["height"]) for row in rows]
    assert answer["points"].dtype == np.int64
    assert answer["points"].tolist() == [int(row["points"]) for row in rows]
    assert answer["none"] == [None] * len(rows)
    assert answer["part"] == [row["part"] or None for row in rows]
    assert None in answer["part"]


def test_terms_have_datatype_and_language_as_in_the_json_results(campus, campus_map):
    text = PREFIX + "SELECT ?v { ?o ?p ?v . FILTER(!isBlank(?v)) } ORDER BY LANG(?v) DATATYPE(?v) ?v"
    expected = json.loads(run("query", campus.file, "-e", text, "--format", "json"))["results"]["bindings"]
    terms = campus_map.query(text).terms("v")
    assert len(terms) == len(expected)
    kinds = {"iri": "uri", "literal": "literal"}
    for term, cell in zip(terms, (row["v"] for row in expected)):
        assert kinds[term.kind] == cell["type"]
        assert term.text == str(term) == cell["value"]
        assert term.language == cell.get("xml:lang")
        if "datatype" in cell:
            assert term.datatype == cell["datatype"]
    assert {"literal", "iri"} <= {term.kind for term in terms}
    assert any(term.language for term in terms)


def test_rows_hold_python_values(campus_map):
    text = 'SELECT * { BIND(7 AS ?i) BIND(2.5 AS ?d) BIND(true AS ?t) BIND("x"@en AS ?s) BIND(1/0 AS ?u) }'
    answer = campus_map.query(text)
    (row,) = answer
    values = dict(zip(answer.variables, row))
    assert values == {"i": 7, "d": 2.5, "t": True, "s": "x", "u": None}
    assert isinstance(values["i"], int) and isinstance(values["d"], float) and values["t"] is True


@pytest.mark.parametrize("values, expected", [
    ('1 UNDEF', [1.0, math.nan]),
    ('1 2.5', [1.0, 2.5]),
    ('"1e3"^^xsd:double "-INF"^^xsd:double', [1000.0, -math.inf]),
    ('9223372036854775807 -9223372036854775808', [2**63 - 1, -2**63]),
    ('9007199254740992 UNDEF', [2.0**53, math.nan]),
    ('1 "one"', ["1", "one"]),
    ('"1" "2"', ["1", "2"]),
    ('1 "x"^^xsd:integer', ["1", "x"]),
    ('true false', ["true", "false"]),
    ('"2.0E0"^^<http://www.w3.org/2001/XMLSchema#double> 1', [2.0, 1.0]),
])
def test_columns_by_their_cells(campus_map, values, expected):
    prefix = "PREFIX xsd: <http://www.w3.org/2001/XMLSchema#> "
    answer = campus_map.query(prefix + "SELECT ?v { VALUES ?v { %s } }" % values)
    column = answer["v"]
    if isinstance(expected[0], str):
        assert column == expected
    else:
        assert column.dtype == (np.int64 if isinstance(expected[0], int) else np.float64)
        np.testing.assert_array_equal(column, expected)
    assert answer.numbers("v").dtype == np.float64
    assert len(answer.texts("v")) == 2


@pytest.mark.parametrize("values, expected", [
    ("9223372036854775808 0", [2**63, 0]),
    ("9007199254740993 UNDEF", [2**53 + 1, None]),
    ("-123456789012345678901234567890 7", [-123456789012345678901234567890, 7]),
])
def test_whole_numbers_keep_all_digits(campus_map, values, expected):
    column = campus_map.query("SELECT ?v { VALUES ?v { %s } }" % values)["v"]
    assert column.dtype == object and column.tolist() == expected
    assert all(value is None or type(value) is int for value in column)


def test_an_empty_answer_has_empty_columns(campus_map):
    answer = campus_map.query("SELECT ?x { ?x <http://example.org/none> ?y }")
    assert len(answer) == 0 and not answer
    assert answer["x"].shape == answer.numbers("x").shape == (0,) and answer["x"].dtype == np.float64
    with pytest.warns(RuntimeWarning):
        assert math.isnan(answer["x"].mean())
    assert answer.texts("x") == []


def test_ask_is_true_or_false(campus_map):
    assert campus_map.query("ASK { ?s ?p ?o }")
    no = campus_map.query("ASK { ?s <http://example.org/none> ?o }")
    assert not no and no.kind == "boolean" and repr(no) == "<cluxel.Answer boolean false>"


def test_construct_gives_triples_of_terms(campus_map):
    answer = campus_map.query(PREFIX + "CONSTRUCT { ?o clx:rule ?r } { ?o clx:rule ?r ; clx:heading ?h }")
    assert answer.kind == "triples" and len(answer) == len(answer.triples) == len(campus_map.objects())
    rules = {subject.text: rule.value for subject, _, rule in answer.triples}
    assert rules == {thing.iri: thing.rule for thing in campus_map.objects()}


@pytest.mark.parametrize("value, expected", [
    (5, ("5", "integer")), (2**70, (str(2**70), "integer")), (0.5, ("5.0E-1", "double")), (True, ("true", "boolean")),
    ("five", ("five", "string")), (np.int64(5), ("5", "integer")), (np.uint8(5), ("5", "integer")),
    (np.float64(0.5), ("5.0E-1", "double")), (np.float32(0.5), ("5.0E-1", "double")), (np.bool_(True), ("true", "boolean")),
    (np.str_("five"), ("five", "string")),
])
def test_bindings_take_python_values(campus_map, value, expected):
    (term,) = campus_map.query("SELECT (?v AS ?w) {}", bindings={"v": value}).terms("w")
    assert (term.text, term.datatype) == (expected[0], "http://www.w3.org/2001/XMLSchema#" + expected[1])
    assert term.value == value


def test_bindings_take_terms(campus_map):
    thing = campus_map.objects()[0]
    answer = campus_map.query(PREFIX + "SELECT ?rule { ?o clx:rule ?rule }", bindings={"o": cluxel.Term.iri(thing.iri)})
    assert answer["rule"] == [thing.rule]
    with pytest.raises(cluxel.InvalidArgumentError, match="not list"):
        campus_map.query("SELECT * {}", bindings={"o": [1]})
    with pytest.raises(cluxel.InvalidArgumentError, match="not datetime64"):
        campus_map.query("SELECT * {}", bindings={"o": np.datetime64("2026-01-01")})


def test_ill_typed_literals_keep_their_text(campus_map):
    xsd = "http://www.w3.org/2001/XMLSchema#"
    for text, datatype in [("maybe", "boolean"), ("1_000", "integer"), ("1_0", "double"), ("infinity", "double"),
                           (" 5", "integer"), ("+-5", "integer"), ("INF", "decimal"), ("1e5", "decimal")]:
        assert cluxel.Term.literal(text, datatype=xsd + datatype).value == text
    assert cluxel.Term.literal("0", datatype=xsd + "boolean").value is False
    assert cluxel.Term.literal("-INF", datatype=xsd + "double").value == float("-inf")
    answer = campus_map.query('SELECT ?v { VALUES ?v { "1e400"^^<%sdouble> 2.5 } }' % xsd)
    assert sorted(answer["v"].tolist()) == [2.5, float("inf")]
    with pytest.raises(cluxel.InvalidArgumentError, match="no variable"):
        campus_map.query("SELECT * { ?o ?p ?v }", bindings={"?o": 1})


def test_terms_are_values():
    one = cluxel.Term.literal("1", datatype="http://www.w3.org/2001/XMLSchema#integer")
    assert one.n3() == '"1"^^<http://www.w3.org/2001/XMLSchema#integer>'
    assert one == cluxel.Term.literal("1", one.datatype) and hash(one) == hash(cluxel.Term.literal("1", one.datatype))
    assert len({one, cluxel.Term.literal("1"), cluxel.Term.literal("1", language="en"), cluxel.Term.iri("1")}) == 4
    assert cluxel.Term.literal("x", language="EN").language == "en"
    with pytest.raises(cluxel.InvalidArgumentError):
        cluxel.Term.literal("x", datatype="http://example.org/t", language="en")


@pytest.mark.parametrize("tag", ["d e", "", "de-", "-de", "1e", "de_CH", "dé"])
def test_language_tags_are_checked(tag):
    with pytest.raises(cluxel.InvalidArgumentError, match="is no language tag"):
        cluxel.Term.literal("a", language=tag)
    assert cluxel.Term.literal("a", language="de-CH-1996").n3() == '"a"@de-ch-1996'


def test_limits_end_a_query(campus_map):
    pairs = "SELECT ?a ?c { ?a ?p ?b . ?c ?q ?d }"
    for limit in ({"deadline_s": 0.005}, {"max_rows": 10}, {"max_memory_bytes": 1 << 20}):
        with pytest.raises(cluxel.BudgetExceededError):
            campus_map.query(pairs, **limit)
    for wrong in (0, -1, math.nan):
        with pytest.raises(cluxel.InvalidArgumentError, match="deadline_s"):
            campus_map.query("ASK {}", deadline_s=wrong)


def test_limits_end_an_update(copied_map):
    pairs = "INSERT { ?a <http://example.org/p> ?d } WHERE { ?a ?p ?b . ?c ?q ?d }"
    before = copied_map.summary().quads
    for limit in ({"deadline_s": 0.005}, {"max_memory_bytes": 1 << 20}):
        with pytest.raises(cluxel.BudgetExceededError):
            copied_map.update(pairs, **limit)
    with pytest.raises(cluxel.InvalidArgumentError, match="deadline_s"):
        copied_map.update(pairs, deadline_s=-1)
    with pytest.raises(cluxel.FaultyInputError, match="mine.ru:1"):
        copied_map.update("INSERT DATA { <a", source_name="mine.ru")
    assert copied_map.summary().quads == before


def test_warnings_name_unknown_properties(campus_map):
    (warning,) = campus_map.query(PREFIX + "SELECT * { ?o clx:hieght ?h }", source_name="mine.rq").warnings
    assert warning.severity == "warning" and warning.file == "mine.rq" and "height" in warning.hint


def test_other_threads_run_during_a_query(campus_map):
    """The query ends only when another thread has answered: it would never end if it kept the interpreter's lock."""
    ended, beats = threading.Event(), []

    def beat():
        while not ended.wait(0.001):
            beats.append(1)

    thread = threading.Thread(target=beat)
    thread.start()
    with pytest.raises(cluxel.BudgetExceededError):
        campus_map.query("SELECT (COUNT(*) AS ?n) { ?a ?p ?b . ?c ?q ?d FILTER(?b != ?d) }", deadline_s=0.5)
    during = len(beats)
    ended.set()
    thread.join()
    assert during > 20


def test_an_answer_outlives_its_map(campus):
    answer = cluxel.open(campus.file).query(TABLE)
    assert answer["o"] == campus.map.query(TABLE)["o"]
