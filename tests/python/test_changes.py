# SPDX-License-Identifier: Apache-2.0
"""Changes give the maps that building gives; `cluxel export --canonical` compares them."""
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


def test_wrong_names_and_poses_are_errors(copied_map):
    with pytest.raises(cluxel.NotFoundError):
        copied_map.retract(["no-such-scan.pcd"])
    with pytest.raises(cluxel.InvalidArgumentError):
        copied_map.repose({copied_map.clouds()[0].id: np.zeros((3, 3))})
    with pytest.raises(cluxel.InvalidArgumentError):
        copied_map.repose({copied_map.clouds()[0].id: 2 * np.eye(4)})
