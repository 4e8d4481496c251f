// SPDX-License-Identifier: Apache-2.0
// Which true trees touch: memory follows a slice of the map, not the map.
#pragma once

#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>
#include <vector>

#include "base/sorting/sorted_records.hpp"

namespace cluxel::tasks {

/// Two trees touch when they have points in the same or in neighbouring cells of 0.25 m.
class TouchingTrees {
 public:
  /// The cells are sorted in a temporary file where they take more than `bytes_in_memory`.
  explicit TouchingTrees(std::size_t bytes_in_memory = SortedRecords::kUsualBytes) : cells_(bytes_in_memory) {}

  /// Throws Error (StoreUnavailable) when there is no room for the temporary file.
  void add(const Eigen::Vector3d& p_map, std::int32_t tree);
  /// The pairs (a < b), and forgets all points. Throws as add().
  std::set<std::array<std::int32_t, 2>> takePairs();

 private:
  struct TreeInCell {
    std::int32_t x = 0, y = 0, z = 0, tree = 0;
    auto operator<=>(const TreeInCell&) const = default;
  };
  using Slice = std::vector<TreeInCell>;  ///< of the same x, sorted
  using Pairs = std::set<std::array<std::int32_t, 2>>;

  void sortNewest();
  static TreeInCell readFrom(std::string_view record);
  static void addPairs(const Slice& slice, const Slice& beside, Pairs& pairs);

  std::vector<TreeInCell> newest_;  ///< not yet in `cells_`
  SortedRecords cells_;
};

}  // namespace cluxel::tasks
