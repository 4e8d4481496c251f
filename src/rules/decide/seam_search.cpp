// SPDX-License-Identifier: Apache-2.0
// Compares traces in the layers of the seam.
#include "rules/decide/seam_search.hpp"

#include <algorithm>

namespace cluxel::rules {

SeamSearch::SeamSearch(const LocalInput& input, const std::vector<char>& is_fixed, double reach_m,
                       std::vector<std::uint32_t> layers)
    : input_(input), is_fixed_(is_fixed), reach_m_(reach_m), is_changed_(input.is_dirty), layers_(std::move(layers)) {}

bool SeamSearch::isInWindow() const {
  for (std::size_t i = 0; i < layers_.size(); ++i)
    if (layers_[i] != kNoLayer && input_.is_open[i] != 0) return false;
  return true;
}

bool SeamSearch::find(std::span<const std::uint64_t> traces, const StepMembers& steps) {
  while (isInWindow()) {
    std::vector<perception::PrimitiveIndex> changed = differing(traces);
    // A step across the seam ties both sides together.
    const auto across = steps.ofStepsAcross(layers_, kLastDecidedLayer, kLastLayer);
    changed.insert(changed.end(), across.begin(), across.end());
    if (!addChanged(changed)) return true;
  }
  return false;
}

std::vector<perception::PrimitiveIndex> SeamSearch::differing(std::span<const std::uint64_t> traces) const {
  std::vector<perception::PrimitiveIndex> primitives;
  for (perception::PrimitiveIndex i = 0; i < layers_.size(); ++i)
    if (layers_[i] != kNoLayer && layers_[i] != 0 && input_.stored_trace[i] != traces[i]) primitives.push_back(i);
  return primitives;
}

bool SeamSearch::addChanged(std::span<const perception::PrimitiveIndex> primitives) {
  bool is_more = false;
  for (const perception::PrimitiveIndex primitive : primitives)
    is_more = std::exchange(is_changed_[primitive], 1) == 0 || is_more;
  if (!is_more) return false;
  if (!search_) search_.emplace(input_.window, is_fixed_, reach_m_);
  layers_ = search_->around(is_changed_, input_.gone);
  return true;
}

std::vector<char> fixedPrimitives(const ReasoningState& state) {
  std::vector<char> is_fixed;
  for (perception::PrimitiveIndex i = 0; i < state.scene.primitives.size(); ++i) {
    const std::vector<FragmentIndex>& fragments = state.fragments.fragmentsOf(i);
    is_fixed.push_back(std::none_of(fragments.begin(), fragments.end(),
                                    [&](FragmentIndex fragment) { return state.fragments[fragment].owner == kFree; })
                           ? 1
                           : 0);
  }
  return is_fixed;
}

}  // namespace cluxel::rules
