// SPDX-License-Identifier: Apache-2.0
// Geometry of objects and parts from their cluxels, and how much each scan saw of them.
#pragma once

#include <map>
#include <vector>

#include "cluxel/perception/cluxel_tile.hpp"
#include "cluxel/perception/scene.hpp"
#include "cluxel/perception/tile_points.hpp"
#include "cluxel/reasoning/semantic_object.hpp"

namespace cluxel {

struct ObjectGeometry {
  UprightBox box;
  Eigen::Vector3d min = Eigen::Vector3d::Constant(1e300), max = Eigen::Vector3d::Constant(-1e300);  ///< [m, map]
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< mean of its points [m, map]
  double bottom_m = 0, top_m = 0;                      ///< above the local ground
  std::uint64_t point_count = 0;                       ///< kept points
};

/// Geometry of a bunch of cluxels of the scene.
ObjectGeometry geometryOf(const SceneCluxels& cluxels, std::span<const std::uint32_t> members);

/// All cluxels of an object, ascending.
std::vector<std::uint32_t> cluxelsOf(const SemanticObject& object);

/// For every cluxel of the scene the number of its object, or kNoObject.
inline constexpr std::uint32_t kNoObject = 0xffffffffU;
std::vector<std::uint32_t> objectOfCluxel(const ReasoningResult& result, std::size_t cluxel_count);

/// What one scan saw of one object.
struct Sighting {
  std::uint64_t point_count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of its points [m, map]
};
/// By (object, scan), from the points of all tiles in canonical order.
std::map<std::pair<std::uint32_t, ScanId>, Sighting> sightingsOf(const std::map<TileKey, TilePoints>& points,
                                                                 const std::map<TileKey, CluxelTile>& cluxels,
                                                                 const std::vector<std::uint32_t>& object_of_cluxel);

/// Pairs of objects (a < b) whose cluxels' boxes come nearer than `largest_m`, sorted; objects that `is_ground` are
/// left out. Cost O(cluxels of objects).
std::vector<std::pair<std::uint32_t, std::uint32_t>> nearObjects(const SceneCluxels& cluxels,
                                                                 const std::vector<std::uint32_t>& object_of_cluxel,
                                                                 const std::vector<bool>& is_ground, double largest_m);

}  // namespace cluxel
