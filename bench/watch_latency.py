#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long after its arrival a scan is in the map that `cluxel watch` extends.

watch_latency.py CLUXEL FOLDER [STOPS [SIZE [SECONDS]]]: makes FOLDER, simulates a drive of STOPS scans (48) on a campus of SIZE
metres (250), and puts a scan into a watched folder every SECONDS (5). The time runs from there to the line that tells of its
commit. Prints a table; the share answerable in time is that of the scans that were in the map before the next arrived.
"""
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path


def follow(output, committed):
    """Notes the time at which the map held 1, 2, ... scans."""
    text = ""
    for line in output:
        text += line
        if line.strip() == "}":
            committed += [time.monotonic()] * (json.loads(text)["scans"] - len(committed))
            text = ""


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, folder = sys.argv[1], Path(sys.argv[2])
    stops, size, every_s = (int(value) for value in (sys.argv[3:] + ["48", "250", "5"][len(sys.argv) - 3:]))
    drive, inbox, map_file = folder / "drive", folder / "inbox", folder / "watched.clx"
    if not drive.exists():
        subprocess.run([program, "simulate", drive, "--seed", "51", "--stops", str(stops), "--size", str(size)], check=True,
                       stdout=subprocess.DEVNULL)
    shutil.rmtree(inbox, ignore_errors=True)
    inbox.mkdir(parents=True)
    map_file.unlink(missing_ok=True)
    watch = subprocess.Popen([program, "watch", inbox, "-o", map_file, "--interval", "0.2", "--idle", "30", "--json"],
                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    arrived, committed = [], []
    reader = threading.Thread(target=follow, args=(watch.stdout, committed))
    reader.start()
    start = time.monotonic() + 1
    for number, scan in enumerate(sorted(drive.glob("scan_*.pcd"))):
        shutil.copy(scan, inbox / "arriving")
        time.sleep(max(0.0, start + number * every_s - time.monotonic()))
        os.rename(inbox / "arriving", inbox / scan.name)
        arrived.append(time.monotonic())
    reader.join()
    watch.wait()
    delays = [done - at for at, done in zip(arrived, committed)]
    ordered = sorted(delays)
    print(f"scans that arrived, in the map: {len(arrived)}, {len(committed)}")
    print(f"seconds to the commit: median {ordered[len(ordered) // 2]:.2f}, "
          f"nine tenths {ordered[len(ordered) * 9 // 10]:.2f}, worst {ordered[-1]:.2f}; last {delays[-1]:.2f}")
    print(f"in the map before the next arrived: {sum(delay <= every_s for delay in delays)} of {len(arrived)}")


if __name__ == "__main__":
    main()
