// SPDX-License-Identifier: Apache-2.0
// Groups of things that changed alike and hang together, be they cluxels or cells of points.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace cluxel::tasks {

/// Whether something is there at both times.
enum class ChangeState : std::uint8_t {
  Undecided,  ///< one of the times does not tell
  Stable,     ///< there at both times, or changed the other way
  Changed,
};

/// Numbers, ascending.
using ChangeGroup = std::vector<std::uint32_t>;

class ChangeGroups {
 public:
  using Visit = std::function<void(std::uint32_t)>;
  /// `for_each_near(i, visit)` visits what is near item i. It is asked about changed items only.
  using ForEachNear = std::function<void(std::uint32_t, const Visit&)>;
  ChangeGroups(std::vector<ChangeState> states, ForEachNear for_each_near)
      : states_(std::move(states)), for_each_near_(std::move(for_each_near)) {}

  /// Groups of `min_size` or more changed items that are near to each other, where most of the decided items near each
  /// of them changed, too; in the order of their first items.
  std::vector<ChangeGroup> all(std::size_t min_size) const;
  /// All changed items in groups of those that are near to each other, whatever else is near; in the same order.
  std::vector<ChangeGroup> connected() const;
  /// The same for some items, in groups of `min_size` or more.
  std::vector<ChangeGroup> connectedAmong(const ChangeGroup& items, std::size_t min_size) const;
  /// The group and what is near it.
  ChangeGroup withNear(const ChangeGroup& group) const;
  /// The share of the decided items that changed.
  double shareOfChanged(const ChangeGroup& items) const;
  /// The same for those in and near the group that lie at the height of its middle item or higher: 1 when all of
  /// something is gone from some height upwards. `height(i)` is that of item i.
  double shareOfChangedAbove(const ChangeGroup& group, const std::function<double(std::uint32_t)>& height) const;

 private:
  bool agrees(std::uint32_t item) const;
  ChangeGroup connectedFrom(std::uint32_t start, std::vector<bool>& is_open) const;
  std::vector<ChangeGroup> groupsOf(std::vector<bool> is_open, std::size_t min_size) const;

  std::vector<ChangeState> states_;
  ForEachNear for_each_near_;
};

}  // namespace cluxel::tasks
