// SPDX-License-Identifier: Apache-2.0
// Which cells are kept of each region: possible parts, cells of possible clusters, and what a later region may join.
#pragma once

#include <vector>

#include "mapping/regions/map_regions.hpp"
#include "tasks/changes/change_groups.hpp"
#include "tasks/changes/kept_cluxels.hpp"
#include "tasks/changes/point_cells.hpp"

namespace cluxel::tasks {

/// Collects cells of one time: possible parts (possibleParts) with the cells near them, and the changed cells of
/// possible clusters. A part is settled as soon as no unread tile holds a cell that may belong to it.
class KeptCells {
 public:
  /// `unread`: the tiles of regions that come later. `cluxels` holds those of this region.
  void add(const mapping::MapRegion& region, std::vector<PointCell> cells, const perception::TileSet& unread,
           const KeptCluxels& cluxels);

  struct Parts {
    std::vector<PointCell> cells;     ///< by key
    std::vector<ChangeGroup> groups;  ///< possible parts
  };
  /// Empty afterwards. No tile may be unread.
  Parts take();

 private:
  void settle(const perception::TileSet& unread);
  void settleOfCluxels(const KeptCluxels& cluxels);

  perception::TileGrid grid_;                ///< of the map
  std::vector<PointCell> open_;              ///< those that reach to unread tiles, with what is near
  std::vector<PointCell> of_cluxels_;        ///< those of changed cluxels of which the clusters are not yet known
  std::vector<PointCell> settled_;           ///< may hold a cell several times
  std::vector<std::vector<CellKey>> parts_;  ///< possible parts
};

}  // namespace cluxel::tasks
