# SPDX-License-Identifier: Apache-2.0
"""build() makes the map that the program makes, reports, and can be stopped."""
import os
import signal
import subprocess
import sys

import pytest

import cluxel
from conftest import SOURCE, run


def canonical(file, folder):
    out = folder / (file.stem + ".nq")
    run("export", "--canonical", file, "-o", out)
    return out.read_bytes()


def test_the_map_is_that_of_the_program(campus, tmp_path):
    run("--home", SOURCE, "build", campus.scans, "-o", tmp_path / "program.clx", "--model", "campus")
    assert canonical(campus.file, tmp_path) == canonical(tmp_path / "program.clx", tmp_path)


def test_progress_counts_each_stage_to_its_end(campus):
    last = {stage: (done, total) for stage, done, total in campus.calls}
    assert last["scans"] == (3, 3)
    assert {"points", "cluxels", "features", "labels", "objects"} <= set(last)
    assert all(done == total for done, total in last.values())


def test_a_list_of_files_and_a_folder_give_the_same_map(campus, tmp_path):
    files = sorted(campus.scans.glob("*.pcd"), reverse=True)
    from_files = campus.build(tmp_path / "files.clx", scans=list(map(str, files)))
    assert canonical(from_files.file, tmp_path) == canonical(campus.file, tmp_path)


def test_a_finished_map_is_replaced_only_on_demand(campus, tmp_path):
    file = tmp_path / "map.clx"
    scan = next(campus.scans.glob("*_000.pcd"))
    campus.build(file, scans=[scan])
    with pytest.raises(cluxel.InvalidArgumentError, match="is a finished map") as raised:
        campus.build(file)
    assert raised.value.remedy == "pass force=True to replace it"
    assert cluxel.open(file).summary().clouds == 1
    assert campus.build(file, force=True).summary().clouds == 3


def test_own_rules_are_used(campus, tmp_path):
    rules = tmp_path / "low.rules.yaml"
    text = (SOURCE / "rules" / "outdoor.rules.yaml").read_text()
    rules.write_text(text.replace("top between 1.2 m and 4.6 m", "top between 1.2 m and 2.5 m"))  # the highest top of a street sign
    built = campus.build(tmp_path / "map.clx", rules=str(rules))
    run("--home", SOURCE, "build", campus.scans, "-o", tmp_path / "program.clx", "--model", "campus", "--rules", rules)
    assert canonical(built.file, tmp_path) == canonical(tmp_path / "program.clx", tmp_path)
    assert len(built.objects("StreetSign")) < len(campus.map.objects("StreetSign"))


def test_an_exception_of_the_callback_ends_the_build_and_the_next_one_completes_it(campus, tmp_path):
    class Enough(Exception):
        pass

    calls = []

    def progress(stage, done, total):
        calls.append(stage)
        if stage == "features":
            raise Enough("of it")

    with pytest.raises(Enough, match="of it"):
        campus.build(tmp_path / "map.clx", progress=progress)
    assert calls.count("features") == 1
    assert canonical(campus.build(tmp_path / "map.clx").file, tmp_path) == canonical(campus.file, tmp_path)


def test_an_exception_in_a_call_from_another_thread_ends_the_build(campus, tmp_path):
    stages = []

    def progress(stage, done, total):
        stages.append(stage)
        if stage == "register":
            raise LookupError("from a worker")

    with pytest.raises(LookupError, match="from a worker"):
        campus.build(tmp_path / "map.clx", refine_poses=True, progress=progress)
    assert stages.count("register") == 1 and stages[-1] == "register"


def test_a_signal_ends_the_build(campus, tmp_path):
    def progress(stage, done, total):
        if stage == "cluxels":
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        campus.build(tmp_path / "map.clx", progress=progress)


QUERY_WITHOUT_END = """
import cluxel, sys
print("ready", flush=True)
cluxel.open(sys.argv[1]).query("SELECT (COUNT(*) AS ?n) { ?a ?p ?b . ?c ?q ?d . FILTER(?b != ?d) }")
"""


def test_ctrl_c_ends_a_query(campus):
    child = subprocess.Popen([sys.executable, "-c", QUERY_WITHOUT_END, str(campus.file)], stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    with pytest.raises(subprocess.TimeoutExpired):
        child.wait(timeout=0.5)
    os.kill(child.pid, signal.SIGINT)
    _, errors = child.communicate(timeout=30)
    assert errors.rstrip().endswith("KeyboardInterrupt")


def test_the_version_is_that_of_the_program():
    assert run("--version").split()[1] == cluxel.__version__
