#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Cuts generated scans (binary PCD of `cluxel simulate`) to the tiles that one of them touches and the tiles around
# them. The cut scans build a map of what an extension by that scan changes: its cost from scratch.
# Usage: bench/cut_tiles.py OUT SCAN SCANS...: SCANS, which may contain SCAN, go to OUT with poses.txt
import struct
import sys
from pathlib import Path

TILE_M = 16.0
RECORD = struct.Struct("<ffffI")  # x y z intensity label


def pose_of(header):
    """Rotation rows and translation of the sensor in the map, from VIEWPOINT: place, then w x y z."""
    tx, ty, tz, w, x, y, z = map(float, next(line for line in header if line.startswith("VIEWPOINT")).split()[1:])
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), tx),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), ty),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), tz))


def read(file):
    """Lines of the header, and the packed records."""
    data = Path(file).read_bytes()
    start = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    header = data[:start].decode("ascii").splitlines()
    if not any(line == "FIELDS x y z intensity label" for line in header):
        sys.exit(f"{file}: fields other than x y z intensity label")
    return header, data[start:]


def tiles_of(header, body):
    """The tile of each record."""
    (a, b, c, d), (e, f, g, h), _ = pose_of(header)
    for x, y, z, _, _ in RECORD.iter_unpack(body):
        yield int((a * x + b * y + c * z + d) // TILE_M), int((e * x + f * y + g * z + h) // TILE_M)


def with_ring(tiles):
    return {(x + i, y + j) for x, y in tiles for i in (-1, 0, 1) for j in (-1, 0, 1)}


def write(file, header, records):
    count = len(records) // RECORD.size
    lines = [f"{line.split()[0]} {count}" if line.split()[0] in ("WIDTH", "POINTS") else line for line in header]
    file.write_bytes(("\n".join(lines) + "\n").encode("ascii") + records)


def main():
    if len(sys.argv) < 4:
        sys.exit(next(line[2:].strip() for line in open(__file__, encoding="utf-8") if "Usage:" in line))
    out = Path(sys.argv[1])
    out.mkdir(parents=True)
    kept = with_ring(set(tiles_of(*read(sys.argv[2]))))
    poses = []
    for file in sys.argv[3:]:
        header, body = read(file)
        records = b"".join(body[i * RECORD.size:(i + 1) * RECORD.size]
                           for i, tile in enumerate(tiles_of(header, body)) if tile in kept)
        if not records:
            continue
        write(out / Path(file).name, header, records)
        poses.append(" ".join(repr(value) for row in pose_of(header) for value in row) + " 0 0 0 1\n")
    (out / "poses.txt").write_text("".join(poses), encoding="ascii")
    print(len(kept))


if __name__ == "__main__":
    main()
