#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Draws the coloured points of a map (`cluxel export MAP -o points.ply`) as seen from above and aside, into a PNG.
# Needs Debian's python3-numpy and python3-pil. Usage:
#   render_map.py points.ply picture.png [--yaw DEG] [--pitch DEG] [--width PIXELS] [--height PIXELS] [--crop X0 X1 Y0 Y1] [--size PIXELS]
import argparse

import numpy
from PIL import Image

TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}


def read_ply(path):
    """The vertices of a binary little-endian PLY file as a structured array."""
    with open(path, "rb") as file:
        fields, count = [], 0
        for line in iter(lambda: file.readline().split(), [b"end_header"]):
            words = [word.decode() for word in line]
            if words[:2] == ["element", "vertex"]:
                count = int(words[2])
            elif words[0] == "property":
                fields.append((words[2], TYPES[words[1]]))
        return numpy.fromfile(file, numpy.dtype(fields), count)


def view_axes(yaw_deg, pitch_deg):
    """Unit vectors to the right, up, and towards the viewer."""
    yaw, pitch = numpy.radians([yaw_deg, pitch_deg])
    right = numpy.array([numpy.cos(yaw), numpy.sin(yaw), 0])
    forward = numpy.array([-numpy.sin(yaw), numpy.cos(yaw), 0])
    up = forward * numpy.sin(pitch) + numpy.array([0, 0, numpy.cos(pitch)])
    towards = -forward * numpy.cos(pitch) + numpy.array([0, 0, numpy.sin(pitch)])
    return right, up, towards


def draw(points, colours, args):
    """Orthographic picture with a depth buffer; dark edges where depth jumps make shapes readable."""
    right, up, towards = view_axes(args.yaw, args.pitch)
    u, v, depth = points @ right, points @ up, points @ towards
    scale = min(args.width / (numpy.ptp(u) * 1.02), args.height / (numpy.ptp(v) * 1.02))
    x = ((u - (u.min() + u.max()) / 2) * scale + args.width / 2).astype(int)
    y = (args.height / 2 - (v - (v.min() + v.max()) / 2) * scale).astype(int)
    image = numpy.full((args.height, args.width, 3), 255, numpy.uint8)
    nearest = numpy.full((args.height, args.width), -numpy.inf)
    order = numpy.argsort(depth)
    for dy in range(args.size):
        for dx in range(args.size):
            row, column = numpy.clip(y + dy, 0, args.height - 1), numpy.clip(x + dx, 0, args.width - 1)
            closer = depth[order] > nearest[row[order], column[order]]
            keep = order[closer]
            image[row[keep], column[keep]] = colours[keep]
            nearest[row[keep], column[keep]] = depth[keep]
    seen = numpy.isfinite(nearest)
    filled = numpy.where(seen, nearest, nearest[seen].min())
    drop = numpy.maximum.reduce([numpy.roll(filled, step, axis) - filled for axis in (0, 1) for step in (-2, 2)])
    shade = numpy.clip(1 - 0.12 * drop, 0.55, 1)
    return (image * numpy.where(seen, shade, 1)[..., None]).astype(numpy.uint8)


def main():
    parser = argparse.ArgumentParser(description="Draw the points of a map exported as PLY.")
    parser.add_argument("ply")
    parser.add_argument("png")
    parser.add_argument("--yaw", type=float, default=30)
    parser.add_argument("--pitch", type=float, default=40)
    parser.add_argument("--width", type=int, default=1200)
    parser.add_argument("--height", type=int, default=600)
    parser.add_argument("--size", type=int, default=2, help="pixels a point")
    parser.add_argument("--crop", type=float, nargs=4, metavar=("X0", "X1", "Y0", "Y1"), help="bounds in the map frame [m]")
    args = parser.parse_args()
    vertices = read_ply(args.ply)
    points = numpy.stack([vertices[axis] for axis in "xyz"], axis=1).astype(float)
    colours = numpy.stack([vertices[name] for name in ("red", "green", "blue")], axis=1)
    if args.crop:
        x0, x1, y0, y1 = args.crop
        inside = (points[:, 0] > x0) & (points[:, 0] < x1) & (points[:, 1] > y0) & (points[:, 1] < y1)
        points, colours = points[inside], colours[inside]
    Image.fromarray(draw(points, colours, args)).save(args.png, optimize=True)


if __name__ == "__main__":
    main()
