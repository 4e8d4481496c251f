// SPDX-License-Identifier: Apache-2.0
// Winners are visited by the gap of their boxes, until no other can be nearer.
#include "rules/propose/first_winners.hpp"

#include <algorithm>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

namespace {

double lengthOf(Eigen::Vector3d apart, bool in_plan) {
  if (in_plan) apart.z() = 0;
  return apart.norm();
}

double gapOf(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, bool in_plan) {
  return lengthOf((a.min() - b.max()).cwiseMax(b.min() - a.max()).cwiseMax(0), in_plan);
}

bool haveCommon(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  for (auto x = a.begin(), y = b.begin(); x != a.end() && y != b.end();) {
    if (*x == *y) return true;
    *x < *y ? ++x : ++y;
  }
  return false;
}

}  // namespace

FirstWinners::FirstWinners(const ReasoningState& after, std::size_t first) {
  for (std::size_t i = first; i < after.objects.size(); ++i) {
    Winner winner;
    winner.class_number = after.objects[i].class_number;
    Candidate all;
    for (const PartInMaking& part : after.objects[i].parts)
      all.fragments.insert(all.fragments.end(), part.fragments.begin(), part.fragments.end());
    winner.cluxels = after.fragments.cluxelsOf(all);
    for (const std::uint32_t cluxel : winner.cluxels) {
      const Eigen::Vector3d half = after.scene.cluxels.extent[cluxel].cast<double>() / 2;
      winner.box.extend(Eigen::Vector3d(after.scene.cluxels.center[cluxel] - half));
      winner.box.extend(Eigen::Vector3d(after.scene.cluxels.center[cluxel] + half));
    }
    if (!winner.cluxels.empty()) winners_.push_back(std::move(winner));
  }
}

std::optional<double> FirstWinners::nearestGap(const ReasoningState& state, const Candidate& candidate,
                                               const std::vector<bool>& classes, bool in_plan, double limit_m) const {
  const Eigen::AlignedBox3d box(candidate.shape.min, candidate.shape.max);
  std::vector<std::pair<double, const Winner*>> near;
  for (const Winner& winner : winners_)
    if (classes[winner.class_number])
      if (const double gap = gapOf(box, winner.box, in_plan); gap <= limit_m) near.emplace_back(gap, &winner);
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const std::vector<std::uint32_t> own = state.fragments.cluxelsOf(candidate);
  std::optional<double> best;
  for (const auto& [box_gap, winner] : near) {
    if (best && box_gap >= *best) break;
    if (haveCommon(own, winner->cluxels)) continue;
    for (const std::uint32_t a : own)
      for (const std::uint32_t b : winner->cluxels) {
        const CluxelGap gap = gapBetween(state.scene.cluxels, a, b);
        const double measured = in_plan ? gap.horizontal : gap.gap();
        if (measured <= limit_m && (!best || measured < *best)) best = measured;
      }
  }
  return best;
}

}  // namespace cluxel::rules
