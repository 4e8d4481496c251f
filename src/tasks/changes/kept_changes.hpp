// SPDX-License-Identifier: Apache-2.0
// What is kept of each region: what changed there, and what is near a change or at the border of the region.
#pragma once

#include <vector>

#include "mapping/map_regions.hpp"
#include "tasks/changes/changed_cluxels.hpp"
#include "tasks/changes/point_cells.hpp"

namespace cluxel::tasks {

/// Collects cluxels that changed with those that intersect them.
class KeptCluxels {
 public:
  /// `changes` of the cluxels of the region's scene; those outside of its tiles are not read.
  void add(const mapping::MapRegion& region, const std::vector<CluxelChange>& changes,
           const std::vector<bool>& is_told);
  /// All that were kept, without those that intersect no changed one. Empty afterwards. Rays are not looked at.
  ChangedCluxels take();

 private:
  struct Kept {
    std::uint32_t number = 0, object = 0;
    CluxelChange change = CluxelChange::Undecided;
    bool is_told = false;
    Eigen::Vector3d center, low_corner;
    Eigen::Vector3f extent;
    std::vector<std::uint32_t> neighbours;  ///< numbers in the map's scene; of a changed one
  };
  std::vector<Kept> kept_;
};

/// Collects cells of one time: those that changed, and those near them. Changed cells that hang together are dropped
/// when nothing can follow from them: they hold no possible part (possibleParts), and none of their cluxels changed.
class KeptCells {
 public:
  /// `unread`: the tiles of regions that come later. What reaches to them is not decided yet.
  void add(const mapping::MapRegion& region, std::vector<PointCell> cells, const perception::TileSet& unread);
  /// All that were kept, by key. Empty afterwards. No tile may be unread.
  std::vector<PointCell> take();

 private:
  void settle(const perception::TileSet& unread);

  std::vector<PointCell> open_;                  ///< those that reach to unread tiles, with what is near
  std::vector<std::vector<PointCell>> settled_;  ///< of each region; two may hold the same cell
};

}  // namespace cluxel::tasks
