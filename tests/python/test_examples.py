# SPDX-License-Identifier: Apache-2.0
"""The examples run as a user starts them."""
import re
import subprocess
import sys

from conftest import SOURCE


def example(name, *arguments):
    words = [sys.executable, str(SOURCE / "examples" / "python" / name), *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True)


def test_the_example_builds_asks_and_explains(campus, tmp_path):
    done = example("build_and_ask.py", campus.scans, tmp_path / "map.clx")
    assert done.returncode == 0, done.stderr
    assert re.search(r"^[1-9]\d* trees, on average \d+\.\d m high$", done.stdout, re.M)
    assert re.search(r"^tree at \[.*\] m: \d+ points", done.stdout, re.M) and "why:" in done.stdout


def test_the_example_counts_all_points(campus):
    done = example("points_by_class.py", campus.file)
    assert done.returncode == 0, done.stderr
    classes = re.findall(r"^\S.*?(\{.*\})$", done.stdout, re.M)
    assert len(classes) == 3 and all("'tree'" in line for line in classes)
    assert sum(map(int, re.findall(r": (\d+)", " ".join(classes)))) == campus.map.summary().points


def test_the_example_reports_a_missing_map(tmp_path):
    done = example("points_by_class.py", tmp_path / "absent.clx")
    assert done.returncode == 1 and "there is no such file" in done.stderr and "Traceback" not in done.stderr
