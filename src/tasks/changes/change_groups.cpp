// SPDX-License-Identifier: Apache-2.0
// Groups are connected components of the changed items that agree with what is near them.
#include "tasks/changes/change_groups.hpp"

#include <algorithm>

namespace cluxel::tasks {

std::vector<ChangeGroup> ChangeGroups::all(std::size_t min_size) const {
  std::vector<bool> is_open(states_.size());
  for (std::uint32_t i = 0; i < states_.size(); ++i) is_open[i] = states_[i] == ChangeState::Changed && agrees(i);
  return groupsOf(std::move(is_open), min_size);
}

std::vector<ChangeGroup> ChangeGroups::connected() const {
  std::vector<bool> is_open(states_.size());
  for (std::uint32_t i = 0; i < states_.size(); ++i) is_open[i] = states_[i] == ChangeState::Changed;
  return groupsOf(std::move(is_open), 1);
}

std::vector<ChangeGroup> ChangeGroups::connectedAmong(const ChangeGroup& items, std::size_t min_size) const {
  std::vector<bool> is_open(states_.size(), false);
  for (const std::uint32_t item : items) is_open[item] = states_[item] == ChangeState::Changed;
  return groupsOf(std::move(is_open), min_size);
}

std::vector<ChangeGroup> ChangeGroups::groupsOf(std::vector<bool> is_open, std::size_t min_size) const {
  std::vector<ChangeGroup> groups;
  for (std::uint32_t start = 0; start < states_.size(); ++start) {
    if (!is_open[start]) continue;
    ChangeGroup group = connectedFrom(start, is_open);
    if (group.size() >= min_size) groups.push_back(std::move(group));
  }
  return groups;
}

ChangeGroup ChangeGroups::withNear(const ChangeGroup& group) const {
  ChangeGroup all = group;
  for (const std::uint32_t item : group) for_each_near_(item, [&](std::uint32_t other) { all.push_back(other); });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

double ChangeGroups::shareOfChanged(const ChangeGroup& items) const {
  double changed = 0, decided = 0;
  for (const std::uint32_t item : items) {
    decided += states_[item] != ChangeState::Undecided ? 1 : 0;
    changed += states_[item] == ChangeState::Changed ? 1 : 0;
  }
  return changed / decided;
}

double ChangeGroups::shareOfChangedAbove(const ChangeGroup& group,
                                         const std::function<double(std::uint32_t)>& height) const {
  std::vector<double> heights;
  for (const std::uint32_t item : group) heights.push_back(height(item));
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>((heights.size() - 1) / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  ChangeGroup above = withNear(group);
  std::erase_if(above, [&](std::uint32_t item) { return height(item) < *middle; });
  return shareOfChanged(above);
}

bool ChangeGroups::agrees(std::uint32_t item) const {
  std::size_t changed = 0, decided = 0;
  for_each_near_(item, [&](std::uint32_t other) {
    decided += states_[other] != ChangeState::Undecided ? 1 : 0;
    changed += states_[other] == ChangeState::Changed ? 1 : 0;
  });
  return 2 * changed > decided;
}

ChangeGroup ChangeGroups::connectedFrom(std::uint32_t start, std::vector<bool>& is_open) const {
  ChangeGroup group{start};
  is_open[start] = false;
  for (std::size_t next = 0; next < group.size(); ++next)
    for_each_near_(group[next], [&](std::uint32_t other) {
      if (!is_open[other]) return;
      is_open[other] = false;
      group.push_back(other);
    });
  std::sort(group.begin(), group.end());
  return group;
}

}  // namespace cluxel::tasks
