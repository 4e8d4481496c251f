// SPDX-License-Identifier: Apache-2.0
// Which cluxels are kept of each region: possible clusters, and what a later region may join.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "mapping/regions/map_regions.hpp"
#include "tasks/changes/changed_cluxels.hpp"

namespace cluxel::tasks {

/// What rays tell of the cluxels of a region's scene.
struct RegionFindings {
  std::vector<bool> is_told;  ///< rays are compared with it
  std::vector<CluxelChange> changes;
  std::vector<RayFindings> gone;          ///< of a changed one: all that the rays of the time without it found
  std::vector<perception::Place> places;  ///< of those in the region's tiles that rays are compared with
};

/// Collects the possible clusters (possibleClusters) of both kinds with the cluxels that intersect them. A cluster is
/// settled as soon as no unread tile holds a cluxel that may belong to it.
class KeptCluxels {
 public:
  /// Findings outside of the region's tiles are not read. `unread`: the tiles of regions that come later.
  void add(const mapping::MapRegion& region, const RegionFindings& found, const perception::TileSet& unread);

  enum class Fate : std::uint8_t { Open, InCluster, Dropped };
  /// What became of a changed cluxel that was added, by its number in the map's scene.
  Fate fateOf(std::uint32_t number) const;

  struct Clusters {
    ChangedCluxels cluxels;                          ///< without what rays found
    std::array<std::vector<ChangeGroup>, 2> groups;  ///< that vanished, and that appeared; numbers in `cluxels`
  };
  /// Empty afterwards. No tile may be unread.
  Clusters take();

 private:
  struct Kept {
    std::uint32_t number = 0, object = 0;
    CluxelChange change = CluxelChange::Undecided;
    bool is_told = false;
    Eigen::Vector3d center, low_corner;
    perception::Place place;
    Eigen::Vector3f extent;
    RayFindings gone;
    std::vector<std::uint32_t> neighbours;         ///< numbers in the map's scene; of a changed one
    std::vector<perception::TileKey> other_tiles;  ///< of its neighbours that lie outside of its region
  };
  /// Sorts by number; of those with one number the first stays.
  static ChangedCluxels assembled(std::vector<Kept>& kept);
  void settle(const perception::TileSet& unread);

  std::vector<Kept> open_;     ///< what reaches to unread tiles, with what is near; ascending
  std::vector<Kept> settled_;  ///< possible clusters, with what is near
  std::array<std::vector<std::vector<std::uint32_t>>, 2> clusters_;  ///< by numbers in the map's scene
  std::unordered_set<std::uint32_t> in_cluster_;
};

}  // namespace cluxel::tasks
