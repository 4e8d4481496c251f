// SPDX-License-Identifier: Apache-2.0
// Boxes, centroids, sightings and neighbours of objects.
#include "mapping/facts/object_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/convex_hull.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

void ExtentSums::add(const ExtentSums& other) {
  min = min.cwiseMin(other.min), max = max.cwiseMax(other.max);
  weighted_centre += other.weighted_centre;
  point_count += other.point_count;
  bottom_m = std::min(bottom_m, other.bottom_m), top_m = std::max(top_m, other.top_m);
  corners.insert(corners.end(), other.corners.begin(), other.corners.end());
}

ExtentSums sumsOf(const perception::SceneCluxels& cluxels, std::span<const std::uint32_t> members) {
  ExtentSums sums;
  for (const std::uint32_t c : members) {
    const Eigen::Vector3d low = cluxels.low_corner[c], high = low + cluxels.extent[c].cast<double>();
    sums.min = sums.min.cwiseMin(low);
    sums.max = sums.max.cwiseMax(high);
    sums.corners.insert(sums.corners.end(), {low.head<2>(), {high.x(), low.y()}, {low.x(), high.y()}, high.head<2>()});
    const double ground = cluxels.center[c].z() - static_cast<double>(cluxels.height_above_ground[c]);
    sums.bottom_m = std::min(sums.bottom_m, low.z() - ground);
    sums.top_m = std::max(sums.top_m, high.z() - ground);
    sums.weighted_centre += cluxels.point_count[c] * cluxels.center[c];
    sums.point_count += cluxels.point_count[c];
  }
  return sums;
}

ObjectGeometry geometryOf(ExtentSums sums) {
  ObjectGeometry geometry;
  geometry.min = sums.min, geometry.max = sums.max;
  geometry.point_count = sums.point_count;
  geometry.centroid = sums.weighted_centre / static_cast<double>(std::max<std::uint64_t>(sums.point_count, 1));
  const FootprintBox box = smallestBox(convexHull(std::move(sums.corners)));
  geometry.box.center << box.center, 0.5 * (geometry.min.z() + geometry.max.z());
  geometry.box.size << box.length_m, box.width_m, geometry.max.z() - geometry.min.z();
  geometry.box.yaw_rad = box.yaw_rad;
  geometry.bottom_m = sums.bottom_m;
  geometry.top_m = sums.top_m;
  return geometry;
}

ObjectGeometry geometryOf(const perception::SceneCluxels& cluxels, std::span<const std::uint32_t> members) {
  return geometryOf(sumsOf(cluxels, members));
}

std::vector<std::uint32_t> cluxelsOf(const rules::SemanticObject& object) {
  std::vector<std::uint32_t> all;
  for (const rules::ObjectPart& part : object.parts) all.insert(all.end(), part.cluxels.begin(), part.cluxels.end());
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::uint32_t> objectOfCluxel(const rules::ReasoningResult& result, std::size_t cluxel_count) {
  std::vector<std::uint32_t> object_of(cluxel_count, kNoObject);
  for (std::uint32_t object = 0; object < result.objects.size(); ++object)
    for (const rules::ObjectPart& part : result.objects[object].parts)
      for (const std::uint32_t cluxel : part.cluxels) object_of[cluxel] = object;
  return object_of;
}

std::map<std::pair<std::uint32_t, scan::ScanId>, Sighting> sightingsOf(
    const std::map<perception::TileKey, perception::SummaryTile>& tiles, const perception::TileGrid& grid,
    const std::vector<std::uint32_t>& object_of_cluxel) {
  std::map<std::pair<std::uint32_t, scan::ScanId>, Sighting> sightings;
  std::uint32_t base = 0;
  for (const auto& [key, tile] : tiles) {
    const Eigen::Vector3d corner = grid.cornerOf(key);
    std::map<std::pair<std::uint32_t, std::uint32_t>, Sighting> of_tile;
    for (std::uint32_t c = 0; c < tile.size(); ++c) {
      const std::uint32_t object = object_of_cluxel[base + c];
      if (object == kNoObject) continue;
      for (std::uint32_t view = tile.view_offset[c]; view < tile.view_offset[c + 1]; ++view) {
        Sighting& sighting = of_tile[{object, tile.view_scan[view]}];
        sighting.point_count += tile.view_point_count[view];
        sighting.sum += tile.view_point_count[view] * (corner + tile.viewMean(c, view));
      }
    }
    for (const auto& [pair, sighting] : of_tile) {
      Sighting& sum = sightings[{pair.first, tile.scans[pair.second]}];
      sum.point_count += sighting.point_count;
      sum.sum += sighting.sum;
    }
    base += static_cast<std::uint32_t>(tile.size());
  }
  return sightings;
}

namespace {

using ObjectPair = std::pair<std::uint32_t, std::uint32_t>;

struct Bounds {
  Eigen::Vector3d low, high;
};

Bounds boundsOf(const perception::SceneCluxels& cluxels, std::uint32_t c) {
  return {cluxels.low_corner[c], cluxels.low_corner[c] + cluxels.extent[c].cast<double>()};
}

double gapOf(const Bounds& a, const Bounds& b) {
  return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

/// The cluxels of one object in one voxel.
struct Piece {
  std::uint32_t object = 0;
  Bounds bounds;
  std::vector<std::uint32_t> cluxels;
};
using VoxelKey = std::array<int, 3>;
using Voxel = std::vector<Piece>;

void addTo(Voxel& voxel, std::uint32_t object, std::uint32_t cluxel, const Bounds& bounds) {
  auto piece = std::find_if(voxel.begin(), voxel.end(), [&](const Piece& known) { return known.object == object; });
  if (piece == voxel.end()) piece = voxel.insert(voxel.end(), {object, bounds, {}});
  piece->bounds = {piece->bounds.low.cwiseMin(bounds.low), piece->bounds.high.cwiseMax(bounds.high)};
  piece->cluxels.push_back(cluxel);
}

class NearPairs {
 public:
  NearPairs(const perception::SceneCluxels& cluxels, double largest_m) : cluxels_(cluxels), largest_m_(largest_m) {}

  /// Compares the pieces of two voxels, unless their objects are known to be near.
  void compare(const Voxel& a, const Voxel& b) {
    for (const Piece& x : a)
      for (const Piece& y : b) {
        if (x.object == y.object || gapOf(x.bounds, y.bounds) > largest_m_) continue;
        const ObjectPair pair = std::minmax(x.object, y.object);
        if (!pairs_.contains(pair) && areNear(x, y)) pairs_.insert(pair);
      }
  }
  std::vector<ObjectPair> sorted() const { return {pairs_.begin(), pairs_.end()}; }

 private:
  bool areNear(const Piece& x, const Piece& y) const {
    for (const std::uint32_t c : x.cluxels) {
      const Bounds mine = boundsOf(cluxels_, c);
      if (gapOf(mine, y.bounds) > largest_m_) continue;
      for (const std::uint32_t d : y.cluxels)
        if (gapOf(mine, boundsOf(cluxels_, d)) <= largest_m_) return true;
    }
    return false;
  }

  const perception::SceneCluxels& cluxels_;
  double largest_m_;
  std::set<ObjectPair> pairs_;
};

}  // namespace

std::vector<ObjectPair> nearObjects(const perception::SceneCluxels& cluxels,
                                    const std::vector<std::uint32_t>& object_of_cluxel,
                                    const std::vector<bool>& is_ground, double largest_m) {
  // The centres of two such boxes are less than `largest_m` plus a large cluxel apart, so that they lie in the same or
  // in neighbouring voxels.
  const double edge = largest_m + 1.0;
  std::map<VoxelKey, Voxel> voxels;
  for (std::uint32_t c = 0; c < cluxels.size(); ++c) {
    const std::uint32_t object = object_of_cluxel[c];
    if (object == kNoObject || is_ground[object]) continue;
    VoxelKey key;
    for (int axis = 0; axis < 3; ++axis)
      key[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(cluxels.center[c][axis] / edge));
    addTo(voxels[key], object, c, boundsOf(cluxels, c));
  }
  NearPairs pairs(cluxels, largest_m);
  for (const auto& [key, voxel] : voxels)
    for (int i = 13; i < 27; ++i) {
      const auto found = voxels.find({key[0] + i / 9 - 1, key[1] + i / 3 % 3 - 1, key[2] + i % 3 - 1});
      if (found != voxels.end()) pairs.compare(voxel, found->second);
    }
  return pairs.sorted();
}

std::vector<std::vector<ContentHash>> nearOf(const std::vector<rules::SemanticObject>& objects,
                                             const perception::SceneCluxels& cluxels,
                                             const std::vector<std::uint32_t>& object_of_cluxel) {
  std::vector<bool> is_ground;
  is_ground.reserve(objects.size());
  for (const rules::SemanticObject& object : objects)
    is_ground.push_back(object.class_iri == rdf::vocabulary::clx("Ground"));
  std::vector<std::vector<ContentHash>> near(objects.size());
  for (const auto& [a, b] : nearObjects(cluxels, object_of_cluxel, is_ground, kNearObjects_m)) {
    near[a].push_back(objects[b].id);
    near[b].push_back(objects[a].id);
  }
  return near;
}

}  // namespace cluxel::mapping
