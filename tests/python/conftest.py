# SPDX-License-Identifier: Apache-2.0
"""A map of the campus that the C++ tests of the facade use, built once a run by the module, and the program beside it."""
import os
import pathlib
import shutil
import subprocess

import pytest

import cluxel

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CAMPUS = ["--seed", "3", "--stops", "3", "--size", "50", "--points-per-stop", "25000"]  # as tests/api/facade_campus.hpp
PREFIX = "PREFIX clx: <https://w3id.org/cluxel/ontology#> "


def run(*arguments):
    """The output of the program `cluxel`, of which CLUXEL_PROGRAM is the path."""
    words = [os.environ["CLUXEL_PROGRAM"], *map(str, arguments)]
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout


class Campus:
    """The scans of the campus, a map of them, and what its build reported."""

    def __init__(self, folder):
        self.scans, self.file, self.calls, self.notes = folder / "scans", folder / "campus.clx", [], []
        run("simulate", self.scans, *CAMPUS)
        self.map = self.build(self.file, progress=lambda *call: self.calls.append(call), note=self.notes.append)

    def build(self, file, scans=None, **options):
        return cluxel.build(scans or self.scans, file, model="campus", home=SOURCE, threads=2, **options)


@pytest.fixture(scope="session")
def campus(tmp_path_factory):
    return Campus(tmp_path_factory.mktemp("campus"))


@pytest.fixture
def campus_map(campus):
    return campus.map


@pytest.fixture
def copied_map(campus, tmp_path):
    """A copy of the map that a test may change."""
    return cluxel.open(shutil.copy(campus.file, tmp_path / "copy.clx"))
