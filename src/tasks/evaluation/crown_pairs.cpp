// SPDX-License-Identifier: Apache-2.0
// Pairs of trees that touch, judged by the objects that have most of their points.
#include "tasks/evaluation/crown_pairs.hpp"

#include <algorithm>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kTrunkDistance_m = 2.0;

}  // namespace

void CrownPairs::add(const Eigen::Vector3d& p_map, std::int32_t instance, bool is_trunk, std::uint32_t object) {
  TrueTree& tree = trees_[instance];
  if (is_trunk) tree.trunk_sum += p_map.head<2>(), ++tree.trunk_points;
  ++tree.objects[object];
  touching_->add(p_map, instance);
}

std::uint32_t CrownPairs::mainObject(const TrueTree& tree) {
  return std::max_element(tree.objects.begin(), tree.objects.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

CrownPairScore CrownPairs::score(const std::vector<std::int32_t>& ambiguous) {
  CrownPairScore score;
  const auto counts = [&](std::int32_t instance) {
    return trees_.at(instance).trunk_points > 0 && !std::binary_search(ambiguous.begin(), ambiguous.end(), instance);
  };
  const auto trunkOf = [](const TrueTree& tree) {
    return Eigen::Vector2d(tree.trunk_sum / static_cast<double>(tree.trunk_points));
  };
  for (const auto& [a, b] : touching_->takePairs()) {
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
