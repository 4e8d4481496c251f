// SPDX-License-Identifier: Apache-2.0
// Every point of a scan is represented in its tile: thinning keeps a point in each voxel.
#include "mapping/build/cluxel_finder.hpp"

#include <string>

#include "mapping/damaged_map.hpp"

namespace cluxel::mapping {

namespace {

template <typename Tile>
const Tile& tileIn(const std::map<perception::TileKey, Tile>& tiles, const perception::TileKey& key) {
  const auto found = tiles.find(key);
  if (found == tiles.end()) refuseIncompleteTile();
  return found->second;
}

}  // namespace

CluxelFinder::CluxelFinder(const perception::TileGrid& grid, const TileStages& stages, const perception::TileKey& tile,
                           const perception::ThinParams& thin)
    : grid_(grid),
      tile_(tile),
      cluxels_(tileIn(stages.cluxels(), tile)),
      kept_(tileIn(stages.points(), tile), thin, grid) {}

std::uint32_t CluxelFinder::cluxelOf(const Eigen::Vector3d& p_map) const {
  const std::uint32_t kept = kept_.find(perception::localPoint(grid_, tile_, p_map));
  if (kept >= cluxels_.point_cluxel.size())
    refuseDamaged("a scan has a point in tile (" + std::to_string(tile_.x) + ", " + std::to_string(tile_.y) +
                  ") for which no point of the tile stands");
  return cluxels_.point_cluxel[kept];
}

}  // namespace cluxel::mapping
