// SPDX-License-Identifier: Apache-2.0
// Extremes merge over tiles in any order. Of the corners only those are kept that the hull of the whole may have.
#include "mapping/regions/object_extents.hpp"

#include <algorithm>

#include "base/convex_hull.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/tile_objects.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/segments/summary_tile.hpp"

namespace cluxel::mapping {

namespace {

using perception::GroundTile;
using perception::Ring;
using perception::SummaryTile;

/// Rounded as the scene rounds, and summed as sumsOf() does.
void addCluxel(const SummaryTile& tile, std::size_t c, const Eigen::Vector3d& corner, const Ring<GroundTile>& around,
               ExtentSums& sums) {
  const Eigen::Vector3f& centre = tile.mean[c];
  const auto above_m = static_cast<float>(centre.z() - groundHeightAt(around, centre.x(), centre.y()));
  const double ground_m = (corner.z() + static_cast<double>(centre.z())) - static_cast<double>(above_m);
  const Eigen::Vector3d low = corner + tile.box_min[c].cast<double>(), high = low + tile.size_m[c].cast<double>();
  sums.min = sums.min.cwiseMin(low), sums.max = sums.max.cwiseMax(high);
  sums.corners.insert(sums.corners.end(), {low.head<2>(), {high.x(), low.y()}, {low.x(), high.y()}, high.head<2>()});
  sums.bottom_m = std::min(sums.bottom_m, low.z() - ground_m), sums.top_m = std::max(sums.top_m, high.z() - ground_m);
  sums.point_count += tile.point_count[c];
}

class ObjectExtents {
 public:
  explicit ObjectExtents(const MapReader& map) : ids_(map.objectIds()), parts_(ids_.size()) {}

  void add(const TileLayer::Share& share, ExtentSums sums) {
    constexpr std::size_t few_corners = 256;
    const auto id = std::lower_bound(ids_.begin(), ids_.end(), share.object);
    if (id == ids_.end() || *id != share.object) refuseDamaged("a tile names an object that is not there");
    sums.corners = outerPoints(std::move(sums.corners));
    Part& part = partNamed(parts_[static_cast<std::size_t>(id - ids_.begin())], share.part_class);
    part.extents.sums.add(sums);
    std::vector<Eigen::Vector2d>& corners = part.extents.sums.corners;
    if (corners.size() < few_corners + 2 * part.thinned) return;
    corners = outerPoints(std::move(corners));
    part.thinned = corners.size();
  }

  std::vector<std::vector<PartExtents>> take() {
    std::vector<std::vector<PartExtents>> all;
    for (std::vector<Part>& parts : parts_) {
      std::vector<PartExtents>& extents = all.emplace_back();
      for (Part& part : parts) extents.push_back(std::move(part.extents));
      std::vector<Part>().swap(parts);
    }
    return all;
  }

 private:
  struct Part {
    PartExtents extents;
    std::size_t thinned = 0;  ///< corners that were left when they were thinned last
  };

  static Part& partNamed(std::vector<Part>& parts, const std::string& name) {
    const auto place = std::lower_bound(parts.begin(), parts.end(), name, [](const Part& part, const std::string& n) {
      return part.extents.part_class < n;
    });
    if (place != parts.end() && place->extents.part_class == name) return *place;
    return *parts.insert(place, {{name, {}}, 0});
  }

  const std::vector<ContentHash>& ids_;
  std::vector<std::vector<Part>> parts_;
};

}  // namespace

std::vector<std::vector<PartExtents>> extentsOfObjects(const MapReader& map) {
  ObjectExtents extents(map);
  const perception::TileGrid grid = storedGrid(map.transaction());
  const auto ground = groundOfTiles(map);
  for (const auto& [key, here] : ground) {
    const auto layer = storedLayer(map.transaction(), key);
    if (!layer) refuseIncompleteTile();
    const std::string_view bytes = requiredBlock(map.transaction(), tables::kSummaries, key);
    const SummaryTile tile = ofTile(key, perception::summaryTileFromBytes(bytes));
    if (layer->size() != tile.size()) refuseDamaged("a stored tile does not fit its objects");
    std::vector<ExtentSums> of_share(layer->shares.size());
    const Ring<GroundTile> around = perception::ringIn(ground, key);
    for (std::size_t c = 0; c < tile.size(); ++c)
      if (const std::uint32_t share = layer->share_of_cluxel[c]; share != kNoShare)
        addCluxel(tile, c, grid.cornerOf(key), around, of_share.at(share));
    for (std::size_t share = 0; share < of_share.size(); ++share)
      if (of_share[share].point_count > 0) extents.add(layer->shares[share], std::move(of_share[share]));
  }
  return extents.take();
}

}  // namespace cluxel::mapping
