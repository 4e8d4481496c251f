# SPDX-License-Identifier: Apache-2.0
"""Builds a map from scans, queries it, and explains an object: python3 build_and_ask.py SCANS MAP.clx"""
import sys

import cluxel

semantic_map = cluxel.build(sys.argv[1], sys.argv[2], force=True)  # force: replace the map of an earlier run

answer = semantic_map.query("""PREFIX clx: <https://w3id.org/cluxel/ontology#>
    SELECT ?tree ?height { ?tree a clx:Tree ; clx:height ?height } ORDER BY DESC(?height)""")
print(len(answer), "trees, on average", answer["height"].mean().round(1), "m high")  # a NumPy array

tree = semantic_map.objects("Tree")[0]
points = semantic_map.points(tree)
print(tree.label, "at", tree.centroid, "m:", points.xyz.shape[0], "points,", *(part.label for part in tree.parts))
print(semantic_map.explain_text(tree))
