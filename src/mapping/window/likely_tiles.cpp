// SPDX-License-Identifier: Apache-2.0
// Only the outermost tiles of the window are looked at.
#include "mapping/window/likely_tiles.hpp"

#include <algorithm>

#include "mapping/build/scan_store.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/window/map_window.hpp"
#include "rules/decide/local_reach.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// Where primitives lie in a tile, other than those of some objects [m, map].
std::vector<Eigen::AlignedBox2d> boxesIn(const TileLayer& layer, const std::set<ContentHash>& but) {
  std::vector<char> is_left_out(layer.primitives.size(), 0);
  for (const TileLayer::Share& share : layer.shares)
    if (but.contains(share.object))
      for (const std::uint32_t component : share.components) is_left_out[component] = 1;
  const Eigen::Vector2d corner = perception::cornerOf(layer.key).head<2>();
  std::vector<Eigen::AlignedBox2d> boxes;
  for (std::size_t i = 0; i < is_left_out.size(); ++i) {
    const Eigen::AlignedBox3f& bounds = layer.primitives[i].bounds;
    if (is_left_out[i] == 0)
      boxes.emplace_back(Eigen::Vector2d(corner + bounds.min().head<2>().cast<double>()),
                         Eigen::Vector2d(corner + bounds.max().head<2>().cast<double>()));
  }
  return boxes;
}

}  // namespace

std::set<ContentHash> objectsOfLoneSeeds(const rules::RuleSet& rules) {
  std::set<ContentHash> objects;
  for (std::size_t i = 0; i < rules::strataOfLoneSeeds(rules); ++i) {
    rules::SemanticObject object;
    object.class_iri = rules.strata[i].front(), object.is_class_wide = true;
    objects.insert(rules::idOf({}, object));
  }
  return objects;
}

TileSet likelyTiles(const rdf::ReadTransaction& transaction, const TileSet& window,
                    const std::set<ContentHash>& lone_objects, double reach_m) {
  const TileSet map = storedTiles(transaction);
  TileSet likely;
  for (const TileKey& tile : window) {
    TileSet outside;
    for (const TileKey& near : perception::ringOf(tile))
      if (map.contains(near) && !window.contains(near)) outside.insert(near);
    const auto layer = outside.empty() ? std::nullopt : storedLayer(transaction, tile);
    if (!layer) continue;
    const std::vector<Eigen::AlignedBox2d> boxes = boxesIn(*layer, lone_objects);
    for (const TileKey& near : outside) {
      const Eigen::AlignedBox2d there = boxOfTile(near);
      if (std::any_of(boxes.begin(), boxes.end(),
                      [&](const auto& box) { return box.exteriorDistance(there) <= reach_m; }))
        likely.insert(near);
    }
  }
  return likely;
}

}  // namespace cluxel::mapping
