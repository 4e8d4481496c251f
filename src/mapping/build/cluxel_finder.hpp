// SPDX-License-Identifier: Apache-2.0
// From a point of a scan to its cluxel.
#pragma once

#include "mapping/build/tile_stages.hpp"

namespace cluxel::mapping {

/// Finds the cluxels of a tile that points of the map's scans belong to. A point that thinning has dropped belongs to
/// the cluxel of the kept point that stands for it.
class CluxelFinder {
 public:
  /// `stages` must have the points of the tile, and keep them. Throws Error (StoreUnavailable) when it has none.
  CluxelFinder(const perception::TileGrid& grid, const TileStages& stages, const perception::TileKey& tile,
               const perception::ThinParams& thin);
  /// The number of the cluxel in the tile. `p_map`: a point of a scan, in this tile. Throws Error (StoreUnavailable)
  /// when no point of the tile stands for it: the map was made of other points. Cost: O(log n).
  std::uint32_t cluxelOf(const Eigen::Vector3d& p_map) const;

 private:
  perception::TileGrid grid_;
  perception::TileKey tile_;
  const perception::CluxelTile& cluxels_;
  perception::RepresentativeFinder kept_;
};

}  // namespace cluxel::mapping
