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

/// Adds the cells of a region that changed, or may be near one that did, to `kept`.
void keepCells(const mapping::MapRegion& region, std::vector<PointCell> cells, std::vector<PointCell>& kept);
/// The cells that changed and those near one of them, by key.
std::vector<PointCell> nearChanges(std::vector<PointCell> cells);

}  // namespace cluxel::tasks
