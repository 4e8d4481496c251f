// SPDX-License-Identifier: Apache-2.0
// Two trees touch when they have points in the same or in neighbouring cells of 0.25 m.
#include "tasks/evaluation/crown_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kTouchCell_m = 0.25;
constexpr double kTrunkDistance_m = 2.0;

}  // namespace

void CrownPairs::add(const Eigen::Vector3d& p_map, std::int32_t instance, bool is_trunk, std::uint32_t object) {
  TrueTree& tree = trees_[instance];
  if (is_trunk) tree.trunk_sum += p_map.head<2>(), ++tree.trunk_points;
  ++tree.objects[object];
  const Eigen::Vector3d cell = (p_map / kTouchCell_m).array().floor();
  trees_of_cell_[{static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
                  static_cast<std::int64_t>(cell.z())}]
      .insert(instance);
}

std::uint32_t CrownPairs::mainObject(const TrueTree& tree) {
  return std::max_element(tree.objects.begin(), tree.objects.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

std::set<std::array<std::int32_t, 2>> CrownPairs::touchingPairs() const {
  std::set<std::array<std::int32_t, 2>> pairs;
  for (const auto& [cell, trees] : trees_of_cell_)
    for (int step = 0; step < 27; ++step) {
      const auto beside =
          trees_of_cell_.find({cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1, cell[2] + step / 9 - 1});
      if (beside == trees_of_cell_.end()) continue;
      for (const std::int32_t a : trees)
        for (const std::int32_t b : beside->second)
          if (a < b) pairs.insert({a, b});
    }
  return pairs;
}

CrownPairScore CrownPairs::score(const std::vector<std::int32_t>& ambiguous) const {
  CrownPairScore score;
  const auto counts = [&](std::int32_t instance) {
    return trees_.at(instance).trunk_points > 0 && !std::binary_search(ambiguous.begin(), ambiguous.end(), instance);
  };
  const auto trunkOf = [](const TrueTree& tree) {
    return Eigen::Vector2d(tree.trunk_sum / static_cast<double>(tree.trunk_points));
  };
  for (const auto& [a, b] : touchingPairs()) {
    if (!counts(a) || !counts(b)) continue;
    const TrueTree &first = trees_.at(a), &second = trees_.at(b);
    if ((trunkOf(first) - trunkOf(second)).norm() < kTrunkDistance_m) continue;
    ++score.pairs;
    const std::uint32_t object = mainObject(first);
    score.parted += object != mapping::kNoObjectOfPoint && mainObject(second) != mapping::kNoObjectOfPoint &&
                            mainObject(second) != object
                        ? 1
                        : 0;
  }
  return score;
}

}  // namespace cluxel::tasks
