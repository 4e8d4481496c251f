// SPDX-License-Identifier: Apache-2.0
// Geometry of objects and parts from their cluxels, and the points each scan contributed.
#pragma once

#include <map>
#include <vector>

#include "perception/segments/scene.hpp"
#include "perception/segments/summary_tile.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

struct ObjectGeometry {
  perception::UprightBox box;
  Eigen::Vector3d min = Eigen::Vector3d::Constant(1e300), max = Eigen::Vector3d::Constant(-1e300);  ///< [m, map]
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< mean of its points [m, map]
  double bottom_m = 0, top_m = 0;                      ///< above the local ground
  std::uint64_t point_count = 0;                       ///< points kept by thinning
};

/// Sums and extremes of some cluxels, which merge over tiles.
struct ExtentSums {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(1e300), max = Eigen::Vector3d::Constant(-1e300);  ///< [m, map]
  Eigen::Vector3d weighted_centre = Eigen::Vector3d::Zero();  ///< sum of centres times points [m, map]
  std::uint64_t point_count = 0;
  double bottom_m = 1e300, top_m = -1e300;  ///< above the local ground
  std::vector<Eigen::Vector2d> corners;     ///< of the cluxels' boxes in plan view, or their hull [m, map]

  void add(const ExtentSums& other);
};
ExtentSums sumsOf(const perception::SceneCluxels& cluxels, std::span<const std::uint32_t> members);
ObjectGeometry geometryOf(ExtentSums sums);

/// Geometry of a set of cluxels of the scene.
ObjectGeometry geometryOf(const perception::SceneCluxels& cluxels, std::span<const std::uint32_t> members);

/// All cluxels of an object, ascending.
std::vector<std::uint32_t> cluxelsOf(const rules::SemanticObject& object);

/// For every cluxel of the scene, the number of its object or kNoObject.
inline constexpr std::uint32_t kNoObject = 0xffffffffU;
std::vector<std::uint32_t> objectOfCluxel(const rules::ReasoningResult& result, std::size_t cluxel_count);

/// The points of one object in one scan.
struct Sighting {
  std::uint64_t point_count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of its points, those of a cluxel rounded by 1 mm [m, map]
};
/// By (object, scan). `tiles`: all of the scene, which lie in `grid`. Cluxels are summed tile by tile in their order.
std::map<std::pair<std::uint32_t, scan::ScanId>, Sighting> sightingsOf(
    const std::map<perception::TileKey, perception::SummaryTile>& tiles, const perception::TileGrid& grid,
    const std::vector<std::uint32_t>& object_of_cluxel);

/// Pairs of objects (a < b) with a gap below `largest_m` between their cluxels' boxes, sorted. Objects with `is_ground`
/// are left out. Cost O(cluxels of objects).
std::vector<std::pair<std::uint32_t, std::uint32_t>> nearObjects(const perception::SceneCluxels& cluxels,
                                                                 const std::vector<std::uint32_t>& object_of_cluxel,
                                                                 const std::vector<bool>& is_ground, double largest_m);

/// For each object the ids of those that are near it; none of ground. Objects closer than kNearObjects_m are near.
inline constexpr double kNearObjects_m = 1.0;
std::vector<std::vector<ContentHash>> nearOf(const std::vector<rules::SemanticObject>& objects,
                                             const perception::SceneCluxels& cluxels,
                                             const std::vector<std::uint32_t>& object_of_cluxel);

}  // namespace cluxel::mapping
