# SPDX-License-Identifier: Apache-2.0
"""Counts the points of each class and shape in a map, scan by scan: python3 points_by_class.py MAP.clx"""
import sys

import numpy as np

import cluxel

try:
    semantic_map = cluxel.open(sys.argv[1])
except cluxel.StoreUnavailableError as error:
    sys.exit(str(error))

names = np.array([found.label for found in semantic_map.objects()] + ["no object"])  # object -1: the last name
for cloud in semantic_map.clouds():
    points = semantic_map.points(cloud)
    classes, counts = np.unique(names[points.object], return_counts=True)
    print(cloud.source, dict(zip(classes.tolist(), counts.tolist())))
    shapes = np.bincount(points.label, minlength=len(cluxel.LABELS))
    print("  shapes:", dict(zip(cluxel.LABELS, shapes.tolist())))
