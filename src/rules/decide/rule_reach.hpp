// SPDX-License-Identifier: Apache-2.0
// How far a rule looks, and whether something changed within that distance. A rejected seed is judged again only when
// something did.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// The distance in plan view from a seed's primitives beyond which ownership does not matter to a rule's decision [m].
/// Absent when no bound follows from the rule's text.
std::optional<double> reachOf(const Rule& rule, const CluxelGrid& grid);

/// Boxes in which something changed, as cells with the number of the last change.
class NearbyChanges {
 public:
  explicit NearbyChanges(double reach_m) : reach_m_(reach_m) {}

  void add(const Eigen::AlignedBox2d& box);
  /// The number of changes so far.
  std::uint32_t count() const { return count_; }
  /// Whether something within reach of the box changed after the first `known` changes. May also be true for changes up
  /// to a few metres beyond.
  bool anyNear(const Eigen::AlignedBox2d& box, std::uint32_t known) const;

 private:
  double reach_m_;
  std::uint32_t count_ = 0, last_large_ = 0;
  std::unordered_map<std::uint64_t, std::uint32_t> last_;  ///< by cell
};

}  // namespace cluxel::rules
