#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Truth for training beside left-out places: copies the truth of Oakland chunks with everything unknown (-1) that lies
# within 10 m of a left-out chunk, and every object that has points in a left-out chunk.
# Usage: leave_out_border.py DATA OUT LEFT_OUT...   (DATA holds oakland3d and oakland3d_truth; LEFT_OUT: ac, ad, ...)
# Writes OUT/oakland_part2_XX.truth for the other chunks, and a line for each on stdout.
import glob
import gzip
import os
import sys

BORDER_M = 10
GROUND = 0   # one ground spans all chunks: it is no object that crosses a border


def chunk_names(data):
    return sorted(os.path.basename(f).split(".")[0] for f in glob.glob(f"{data}/oakland3d/*.xyz_label_conf"))


def cells_of(data, chunk):
    """The square metre in which each point lies."""
    with open(f"{data}/oakland3d/{chunk}.xyz_label_conf") as lines:
        for line in lines:
            if line.strip() and not line.startswith("#"):
                x, y = line.split(None, 2)[:2]
                yield int(float(x) // 1), int(float(y) // 1)


def truth_of(data, chunk):
    """Per point primitive, object and instance, as in the truth file."""
    with gzip.open(f"{data}/oakland3d_truth/{chunk}.truth.gz", "rt") as lines:
        return [tuple(map(int, line.split())) for line in lines]


def near_offsets():
    """Offsets of the cells that can hold a point within BORDER_M of a point of the cell (0, 0)."""
    reach = range(-BORDER_M - 1, BORDER_M + 2)
    gap = lambda n: max(abs(n) - 1, 0)
    return [(i, j) for i in reach for j in reach if gap(i) ** 2 + gap(j) ** 2 <= BORDER_M ** 2]


def border_cells(data, left_out):
    occupied = {cell for chunk in left_out for cell in cells_of(data, chunk)}
    return {(x + i, y + j) for i, j in near_offsets() for x, y in occupied}


def crossing_objects(data, left_out):
    return {truth[2] for chunk in left_out for truth in truth_of(data, chunk) if truth[2] >= 0 and truth[1] != GROUND}


def main():
    data, out, short_names = sys.argv[1], sys.argv[2], sys.argv[3:]
    left_out = [f"oakland_part2_{name}" for name in short_names]
    names = chunk_names(data)
    unknown = [name for name in left_out if name not in names]
    if unknown or not left_out:
        sys.exit(f"leave_out_border.py: no chunk {', '.join(unknown) or 'given'}: the chunks are {', '.join(names)}")
    border, crossing = border_cells(data, left_out), crossing_objects(data, left_out)
    os.makedirs(out, exist_ok=True)
    for chunk in names:
        if chunk in left_out:
            continue
        truth = truth_of(data, chunk)
        kept = 0
        with open(f"{out}/{chunk}.truth", "w") as file:
            for cell, row in zip(cells_of(data, chunk), truth, strict=True):
                keeps = cell not in border and row[2] not in crossing
                kept += keeps
                file.write("%d %d %d\n" % row if keeps else "-1 -1 -1\n")
        print(f"{chunk}: {kept} of {len(truth)} points keep their truth")


main()
