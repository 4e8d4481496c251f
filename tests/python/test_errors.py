# SPDX-License-Identifier: Apache-2.0
"""Errors carry kind, place and remedy; the stub and the docstrings describe the module as it is."""
import ast
import inspect
import pickle
import shutil

import pytest

import cluxel
from conftest import SOURCE

KINDS = {
    "InvalidArgument": cluxel.InvalidArgumentError,
    "NotFound": cluxel.NotFoundError,
    "FaultyInput": cluxel.FaultyInputError,
    "StoreUnavailable": cluxel.StoreUnavailableError,
    "BudgetExceeded": cluxel.BudgetExceededError,
}


def test_each_kind_has_its_class():
    for kind, error in KINDS.items():
        assert error.kind == kind and issubclass(error, cluxel.CluxelError) and error.__doc__
    assert issubclass(cluxel.InvalidArgumentError, ValueError) and issubclass(cluxel.NotFoundError, LookupError)


def test_a_faulty_scan_is_named_with_its_line(campus, tmp_path):
    scan = tmp_path / "scan.xyz"
    scan.write_text("1 2 3\n4 five 6\n")
    with pytest.raises(cluxel.FaultyInputError) as raised:
        campus.build(tmp_path / "map.clx", scans=scan)
    error = raised.value
    assert (error.kind, error.file, error.line) == ("FaultyInput", str(scan), 2)
    assert "scan.xyz:2" in str(error) and error.diagnostics[0].severity == "error"
    assert not (tmp_path / "map.clx").exists()


def test_a_faulty_query_is_named_with_line_and_column(campus_map):
    with pytest.raises(cluxel.FaultyInputError) as raised:
        campus_map.query("SELECT *\nWHERE { ?s ?p }", source_name="mine.rq")
    error = raised.value
    assert (error.file, error.line, error.column) == ("mine.rq", 2, 15)
    assert error.diagnostics[0].source_line == "WHERE { ?s ?p }" and str(error).startswith("mine.rq:2:15: error:")


def test_messages_do_not_end_at_a_nul_character(campus_map):
    with pytest.raises(cluxel.CluxelError) as raised:
        campus_map.objects("\0")
    assert "\\0" in str(raised.value) and len(str(raised.value)) > len("no class \\0")


def test_all_faults_of_a_file_are_reported(campus, tmp_path):
    rules = tmp_path / "town.rules.yaml"
    text = (SOURCE / "rules" / "outdoor.rules.yaml").read_text()
    rules.write_text(text.replace("top <=", "topp <="))
    with pytest.raises(cluxel.FaultyInputError) as raised:
        campus.build(tmp_path / "map.clx", rules=[rules])
    error = raised.value
    assert len(error.diagnostics) > 1 and error.file == str(rules) and error.line == error.diagnostics[0].line > 1
    assert {fault.line for fault in error.diagnostics} == {
        number for number, line in enumerate(rules.read_text().split("\n"), 1) if "topp <=" in line}
    assert error.hint is not None and "top" in error.hint


def test_empty_paths_and_wrong_types_are_errors(campus, tmp_path):
    for call in (lambda: cluxel.open(""), lambda: campus.build(""), lambda: cluxel.merge([campus.file], ""),
                 lambda: cluxel.merge([""], tmp_path / "new.clx")):
        with pytest.raises(cluxel.InvalidArgumentError, match="the path is empty"):
            call()
    with pytest.raises(cluxel.FaultyInputError, match="an empty path names no file"):
        campus.build(tmp_path / "map.clx", scans=[""])
    with pytest.raises(TypeError):
        cluxel.open(5)
    with pytest.raises(TypeError):
        campus.map.query("ASK {}", max_rows="many")


@pytest.mark.parametrize("bindings, why", [({3: 1}, "the name of a variable is a str, not int"),
                                           ({"\ud800": 1}, "the name of a variable is a str that cannot be written"),
                                           ({"x": "\ud800"}, "a value is a str that cannot be written")])
def test_bindings_of_wrong_types_are_errors_of_type(campus_map, bindings, why):
    with pytest.raises(TypeError, match=why):
        campus_map.query("ASK { ?s ?p ?x }", bindings=bindings)


def test_hints_can_be_followed_in_python(campus, copied_map, tmp_path):
    for call, command in ((lambda: copied_map.update("LOAD <http://e/f>"), "cluxel update --load"),
                          (lambda: copied_map.query("ASK { SERVICE <http://e/s> { ?s ?p ?o } }"), "cluxel query --service")):
        with pytest.raises(cluxel.CluxelError) as raised:
            call()
        assert command in raised.value.remedy and raised.value.remedy in str(raised.value)
    other = tmp_path / "other.ttl"
    other.write_text("@prefix owl: <http://www.w3.org/2002/07/owl#> .\n<http://e/Thing> a owl:Class .\n")
    ontology = [*sorted((SOURCE / "ontology").glob("*.ttl")), other]
    campus.build(tmp_path / "other.clx", ontology=ontology)
    with pytest.raises(cluxel.InvalidArgumentError) as raised:
        cluxel.merge([campus.file, tmp_path / "other.clx"], tmp_path / "both.clx")
    assert "use=MAP" in raised.value.remedy
    merged = cluxel.merge([campus.file, tmp_path / "other.clx"], tmp_path / "both.clx", use=tmp_path / "other.clx")
    assert merged.query("ASK { <http://e/Thing> ?p ?o }")


def test_a_merge_replaces_a_map_by_force_only(campus, copied_map, tmp_path):
    copied_map.retract([copied_map.clouds()[0].id])
    twin = shutil.copy(campus.file, tmp_path / "twin.clx")
    with pytest.raises(cluxel.InvalidArgumentError, match="exists already") as raised:
        cluxel.merge([campus.file, twin], copied_map.file)
    assert "force=True" in raised.value.remedy
    copied_map.update("INSERT DATA { <http://e/a> <http://e/b> 1 }")
    with pytest.raises(cluxel.InvalidArgumentError, match="has operator statements") as raised:
        cluxel.merge([campus.file, twin], copied_map.file, force=True)
    assert "drop_statements=True" in raised.value.remedy and copied_map.query("ASK { <http://e/a> ?p 1 }")
    drop = dict(force=True, drop_statements=True)
    scans = len(copied_map.clouds())
    assert cluxel.merge_into([campus.file, twin], copied_map.file, dry_run=True, **drop).scans_already_there > 0
    assert len(copied_map.clouds()) == scans
    assert len(cluxel.merge([campus.file, twin], copied_map.file, **drop).clouds()) == scans + 1
    assert not copied_map.query("ASK { <http://e/a> ?p 1 }")


def test_what_is_not_known_is_none(tmp_path):
    with pytest.raises(cluxel.StoreUnavailableError, match="there is no such file") as raised:
        cluxel.open(tmp_path / "absent.clx")
    error = raised.value
    assert error.file is error.line is error.column is error.hint is error.remedy is None and error.diagnostics == ()


def test_a_missing_data_folder_is_told_with_its_remedy(campus, tmp_path):
    with pytest.raises(cluxel.FaultyInputError) as raised:
        cluxel.build(campus.scans, tmp_path / "map.clx", home=tmp_path)
    assert "home=FOLDER" in raised.value.remedy and raised.value.remedy in str(raised.value)


def test_errors_can_be_pickled(campus_map):
    with pytest.raises(cluxel.FaultyInputError) as raised:
        campus_map.query("SELECT {")
    copy = pickle.loads(pickle.dumps(raised.value))
    assert type(copy) is cluxel.FaultyInputError and copy.diagnostics == raised.value.diagnostics


def test_wrong_types_are_refused(campus_map):
    for call in (lambda: campus_map.query(7), lambda: campus_map.points(7.5), lambda: cluxel.open(7), lambda: cluxel.Map()):
        with pytest.raises(TypeError):
            call()


def names_in(body):
    """name -> node of what a stub declares, private names and typing's imports apart."""
    found = {}
    for node in body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            found[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            found[node.target.id] = node
    return found


STUB = names_in(ast.parse((SOURCE / "python" / "cluxel.pyi").read_text()).body)


def public(names):
    return {name for name in names if not name.startswith("_")}


def test_the_stub_declares_what_the_module_has():
    assert public(STUB) == public(dir(cluxel))
    for name, node in STUB.items():
        if isinstance(node, ast.ClassDef) and not issubclass(getattr(cluxel, name), (tuple, Exception)):
            members = names_in(node.body)
            assert public(members) == public(vars(getattr(cluxel, name))), name
            assert all(hasattr(getattr(cluxel, name), member) for member in members), name
    assert cluxel.Diagnostic._fields == tuple(names_in(STUB["Diagnostic"].body))
    assert cluxel.UpdateCounts._fields == tuple(names_in(STUB["UpdateCounts"].body))
    assert set(names_in(STUB["CluxelError"].body)) == public(vars(cluxel.CluxelError))


def arguments_of(node):
    return [argument.arg for argument in node.args.args + node.args.kwonlyargs]


@pytest.mark.parametrize("owner, name", [(None, "build"), (None, "open"), ("Map", "query"), ("Map", "objects"),
                                         ("Map", "points"), ("Map", "explain"), ("Map", "update"), ("Term", "literal")])
def test_the_stub_names_the_arguments_of_the_module(owner, name):
    node = names_in(STUB[owner].body)[name] if owner else STUB[name]
    signature = getattr(getattr(cluxel, owner) if owner else cluxel, name).__doc__.split("\n")[0]
    positions = [signature.find(argument + ": ") for argument in arguments_of(node)]
    assert -1 not in positions and positions == sorted(positions), signature
    assert signature.count(": ") == len(positions), signature


def test_everything_has_a_docstring():
    for name in public(dir(cluxel)) - {"LABELS", "GROUND_KINDS"}:
        assert inspect.getdoc(getattr(cluxel, name)), name
        if isinstance(getattr(cluxel, name), type):
            for member in public(vars(getattr(cluxel, name))):
                value = inspect.getattr_static(getattr(cluxel, name), member)
                if callable(value) or isinstance(value, property):
                    text = (inspect.getdoc(value) or "").split("->", 1)[-1]
                    assert len(text.split()) > 2, f"{name}.{member}"
