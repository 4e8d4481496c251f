// SPDX-License-Identifier: Apache-2.0
// Compares traces layer by layer.
#include "rules/decide/seam_search.hpp"

#include <algorithm>

namespace cluxel::rules {

namespace {

constexpr std::uint32_t kFirstSeam = 1;  ///< layer 0 has no trace to compare with
constexpr std::uint32_t kSeamWidth = 2;  ///< the last layer of the narrowest seam, counted from its first

}  // namespace

SeamSearch::SeamSearch(const LocalInput& input, const std::vector<std::uint32_t>& layers)
    : input_(input), layer_(layers) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (layers[i] == kNoLayer) continue;
    last_ = std::max(last_, layers[i]);
    if (input.is_open[i] != 0) first_open_ = std::min(first_open_, layers[i]);
  }
}

bool SeamSearch::mayFind() const {
  return first_open_ > kFirstSeam + kSeamWidth;
}

std::vector<Seam> SeamSearch::find(const ReasoningResult& result, const std::set<LayerSpan>& wide_steps) const {
  const std::vector<char> agrees = agreeingLayers(result.traces);
  std::vector<Seam> seams;
  for (std::uint32_t j = kFirstSeam; j <= last_ + 1; ++j) {
    std::uint32_t end = j + kSeamWidth;
    for (const auto& [low, high] : wide_steps)
      if (low <= j) end = std::max(end, high == kNoLayer ? high : high + 1);
    if (end >= first_open_) break;
    if (std::all_of(agrees.begin() + j, agrees.begin() + std::min(end, last_ + 1) + 1,
                    [](char agreed) { return agreed != 0; }))
      seams.push_back({j, end});
  }
  return seams;
}

/// By layer up to the first without a primitive.
std::vector<char> SeamSearch::agreeingLayers(const std::vector<std::uint64_t>& traces) const {
  std::vector<char> agrees(std::size_t{last_} + 2, 1);
  for (std::size_t i = 0; i < layer_.size(); ++i)
    if (layer_[i] != kNoLayer && input_.stored_trace[i] != traces[i]) agrees[layer_[i]] = 0;
  return agrees;
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
