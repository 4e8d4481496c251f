// SPDX-License-Identifier: Apache-2.0
// Builds a map from scans, queries it, and explains an object: example SCANS MAP.clx
#include <cluxel/cluxel.hpp>
#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: example SCANS MAP.clx\n"), 2;
  cluxel::BuildOptions options;
  options.force = true;  // replace the map of an earlier run
  const cluxel::Map map = cluxel::Map::build({argv[1]}, argv[2], options);

  const cluxel::Answer answer = map.query(
      "PREFIX clx: <https://w3id.org/cluxel/ontology#>\n"
      "SELECT ?tree ?height { ?tree a clx:Tree ; clx:height ?height } ORDER BY DESC(?height)");
  for (const auto row : answer) std::printf("%s is %.1f m high\n", row.text("tree").c_str(), row.number("height"));

  const auto trees = map.objects("Tree");
  std::printf("%zu objects, %zu of them trees\n", map.summary().objects, trees.size());
  if (trees.empty()) return 0;
  const cluxel::Object& tree = trees.front();
  std::printf("%s at (%.1f, %.1f, %.1f) m, %zu points\n", tree.label.c_str(), tree.centroid.x, tree.centroid.y,
              tree.centroid.z, map.points(tree).size());
  std::printf("%s", map.explain(tree.iri).text.c_str());
} catch (const cluxel::Error& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
