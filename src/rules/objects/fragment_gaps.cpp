// SPDX-License-Identifier: Apache-2.0
// The look around a cluxel reaches as far as a fragment whose bounds are near it may still be nearer than known.
#include "rules/objects/fragment_gaps.hpp"

#include <algorithm>
#include <utility>

namespace cluxel::rules {

namespace {

class GapSearch {
 public:
  GapSearch(const ReasoningState& state, std::vector<FragmentIndex> fragments, double within_m)
      : state_(state), within_m_(within_m) {
    std::sort(fragments.begin(), fragments.end());
    for (const FragmentIndex fragment : fragments) {
      gaps_.push_back({fragment});
      bounds_.push_back(boundsOf(state.fragments, fragment));
    }
  }

  void lookFrom(std::uint32_t cluxel) {
    const double search_m = searchFrom(cluxel);
    if (search_m < 0) return;
    auto last = static_cast<FragmentIndex>(state_.fragments.size());  // many cluxels of a cell are of one fragment
    FragmentGap* gap = nullptr;
    state_.grid.near(cluxel, search_m, [&](std::uint32_t other) {
      const FragmentIndex theirs = state_.fragments.fragmentOf(other);
      if (std::exchange(last, theirs) != theirs) gap = gapOf(theirs);
      if (gap == nullptr) return;
      gap->gap_m = std::min(gap->gap_m, gapBetween(state_.scene.cluxels, other, cluxel).gap());
    });
  }

  std::vector<FragmentGap> take() { return std::move(gaps_); }

 private:
  /// Null when the gap to the fragment is not asked for.
  FragmentGap* gapOf(FragmentIndex fragment) {
    const auto gap = std::lower_bound(gaps_.begin(), gaps_.end(), fragment,
                                      [](const FragmentGap& known, FragmentIndex key) { return known.fragment < key; });
    return gap != gaps_.end() && gap->fragment == fragment ? &*gap : nullptr;
  }
  /// Negative when no gap can become smaller.
  double searchFrom(std::uint32_t cluxel) const {
    const Eigen::AlignedBox3d box = boxAround(state_.scene.cluxels, std::span(&cluxel, 1));
    double search_m = -1;
    for (std::size_t i = 0; i < gaps_.size(); ++i) {
      const double reach_m = std::min(within_m_, gaps_[i].gap_m);
      if (gaps_[i].gap_m > 0 && reach_m > search_m && isWithin(bounds_[i], box, reach_m)) search_m = reach_m;
    }
    return search_m;
  }

  const ReasoningState& state_;
  double within_m_;
  std::vector<FragmentGap> gaps_;
  std::vector<Eigen::AlignedBox3d> bounds_;
};

}  // namespace

std::vector<FragmentGap> gapsTo(const ReasoningState& state, std::span<const std::uint32_t> cluxels,
                                std::vector<FragmentIndex> fragments, double within_m) {
  GapSearch search(state, std::move(fragments), within_m);
  for (const std::uint32_t cluxel : cluxels) search.lookFrom(cluxel);
  return search.take();
}

}  // namespace cluxel::rules
