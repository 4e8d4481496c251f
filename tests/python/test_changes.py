# SPDX-License-Identifier: Apache-2.0
"""Changes give the maps that building gives; `cluxel export --canonical` compares them."""
import os
import signal
import threading

import numpy as np
import pytest

import cluxel

from conftest import run


def canonical(map):
    return run("export", map.file, "--canonical")


def test_a_retracted_scan_comes_back_by_extending(campus, copied_map):
    before = canonical(copied_map)
    clouds = copied_map.clouds()
    changes = copied_map.retract([clouds[0].id])
    assert (changes.scans_removed, len(copied_map.clouds())) == (1, len(clouds) - 1)
    assert canonical(copied_map) != before
    changes = copied_map.extend(campus.scans)
    assert (changes.scans_added, changes.scans_already_there) == (1, len(clouds) - 1)
    assert canonical(copied_map) == before
    there = {o.iri for o in copied_map.objects()}
    assert all((change.iri in there) == (change.kind != "gone") for change in changes.objects)


def test_a_scan_moves_there_and_back(copied_map):
    before = canonical(copied_map)
    cloud = copied_map.clouds()[0]
    moved = np.array(cloud.T_map_sensor).reshape(4, 4)
    moved[0, 3] += 0.5
    assert copied_map.repose({cloud.id: moved}, dry_run=True).scans_moved == 1
    assert canonical(copied_map) == before
    copied_map.repose({cloud.id: moved})
    assert canonical(copied_map) != before
    copied_map.repose({cloud.id: np.array(cloud.T_map_sensor).reshape(4, 4)})
    assert canonical(copied_map) == before


def test_merged_maps_are_the_map_of_all_scans(campus, tmp_path):
    files = sorted(campus.scans.glob("*.pcd"))
    poses = [line for line in (campus.scans / "poses.txt").read_text().splitlines() if not line.startswith("#")]
    parts = []
    for number, chosen in enumerate((files[:1], files[1:])):
        folder = tmp_path / str(number)
        folder.mkdir()
        for file in chosen:
            (folder / file.name).symlink_to(file)
        lines = [poses[files.index(file)] for file in chosen]
        (folder / "poses.txt").write_text("\n".join(lines) + "\n")
        times = (campus.scans / "times.txt").read_text().splitlines()
        (folder / "times.txt").write_text("\n".join(times[files.index(file)] for file in chosen) + "\n")
        parts.append(campus.build(tmp_path / f"{number}.clx", folder).file)
    merged = cluxel.merge(parts, tmp_path / "merged.clx")
    assert canonical(merged) == canonical(campus.map)
    second = cluxel.open(parts[1])
    forth = np.eye(4)
    forth[0, 3] = 64  # four tiles, and exact in binary
    second.repose({cloud.id: forth @ cloud.T_map_sensor for cloud in second.clouds()})
    back = np.linalg.inv(forth)
    moved = cluxel.merge(parts, tmp_path / "moved.clx", T_first_second=back)
    assert canonical(moved) == canonical(campus.map)
    with pytest.raises(cluxel.InvalidArgumentError, match="T_first_second has another shape"):
        cluxel.merge(parts, tmp_path / "none.clx", T_first_second=np.eye(3))
    with pytest.raises(cluxel.InvalidArgumentError, match="does not scale"):
        cluxel.merge(parts, tmp_path / "none.clx", T_first_second=np.diag([2, 2, 2, 1]))


def test_callbacks_read_the_map_and_may_not_write_it(copied_map):
    seen, refused = [], []

    def look(*_):
        if len(seen) > 2:
            return
        thing, scan = copied_map.objects()[0], copied_map.clouds()[0]
        seen.append((copied_map.summary().clouds, len(copied_map.points(scan)), len(copied_map.points(thing)),
                     len(copied_map.explain_text(thing)), len(copied_map.query("ASK { ?s ?p ?o }"))))
        for write in (lambda: copied_map.update("INSERT DATA { <http://a> <http://b> 1 }"),
                      lambda: copied_map.retract([scan.id])):
            with pytest.raises(cluxel.InvalidArgumentError, match="a callback of a call that writes this map"):
                write()
            refused.append(write)

    clouds = copied_map.clouds()
    copied_map.retract([clouds[0].id], progress=look, note=look)
    assert len(refused) == 2 * len(seen) == 6 and seen[0][0] == len(clouds)
    assert copied_map.summary().clouds == len(clouds) - 1


def test_wrong_names_and_poses_are_errors(copied_map):
    with pytest.raises(cluxel.NotFoundError):
        copied_map.retract(["no-such-scan.pcd"])
    with pytest.raises(cluxel.InvalidArgumentError):
        copied_map.repose({copied_map.clouds()[0].id: np.zeros((3, 3))})
    with pytest.raises(cluxel.InvalidArgumentError):
        copied_map.repose({copied_map.clouds()[0].id: 2 * np.eye(4)})


def in_child(work):
    """The exit status of a forked process: 0 when `work` gives True. One that hangs is killed."""
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        status = 1
        try:
            status = 0 if work() else 2
        finally:
            os._exit(status)
    return os.waitpid(child, 0)[1]


def test_a_forked_process_goes_on_with_the_maps_of_its_parent(copied_map):
    things, is_over = len(copied_map.objects()), threading.Event()

    def write():
        number = 0
        while not is_over.is_set():
            number += 1
            copied_map.update(f"INSERT DATA {{ <http://e/{number}> <http://e/p> 1 }}")

    writer = threading.Thread(target=write)
    writer.start()
    try:
        for _ in range(6):
            assert in_child(lambda: len(copied_map.objects()) == things and len(copied_map.inventory().items) > 5) == 0
    finally:
        is_over.set()
        writer.join()
    assert in_child(lambda: copied_map.update("INSERT DATA { <http://e/c> <http://e/child> 1 }").inserted == 1) == 0
    assert copied_map.query("ASK { <http://e/c> <http://e/child> 1 }")
