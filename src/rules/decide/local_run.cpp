// SPDX-License-Identifier: Apache-2.0
// Looks for a seam: layers in which the run over the window and the run before agree, and that no step spans.
#include "rules/decide/local_run.hpp"

#include <algorithm>
#include <cassert>
#include <set>

#include "rules/decide/reasoning_strata.hpp"

namespace cluxel::rules {

namespace {

constexpr std::uint32_t kFirstSeam = 1;  ///< layer 0 has no trace to compare with
constexpr std::uint32_t kSeamWidth = 2;  ///< the last layer of the narrowest seam, counted from its first

/// The layers of a window in which both runs agree, and those that are not all in the window.
class SeamSearch {
 public:
  SeamSearch(const LocalInput& input, const std::vector<std::uint32_t>& layer) : input_(input), layer_(layer) {
    for (std::size_t i = 0; i < layer.size(); ++i) {
      if (layer[i] == kNoLayer) continue;
      last_ = std::max(last_, layer[i]);
      if (input.is_open[i] != 0) first_open_ = std::min(first_open_, layer[i]);
    }
  }

  /// Whether the narrowest seam next to the change is in the window.
  bool mayFind() const { return first_open_ > kFirstSeam + kSeamWidth; }

  /// All seams, the nearest first.
  std::vector<Seam> find(const ReasoningResult& result, const std::set<LayerSpan>& wide_steps) const {
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

 private:
  /// By layer up to the first without a primitive.
  std::vector<char> agreeingLayers(const std::vector<std::uint64_t>& traces) const {
    std::vector<char> agrees(std::size_t{last_} + 2, 1);
    for (std::size_t i = 0; i < layer_.size(); ++i)
      if (layer_[i] != kNoLayer && input_.stored_trace[i] != traces[i]) agrees[layer_[i]] = 0;
    return agrees;
  }

  const LocalInput& input_;
  const std::vector<std::uint32_t>& layer_;
  std::uint32_t last_ = 0, first_open_ = kNoLayer;
};

/// What the first strata took, each primitive by itself, takes part in no later step: its trace is that of the run
/// before, and a change does not go on through it.
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

/// Whether the likely layers hold. Dirty primitives are in layer 0, fixed or not.
bool areLikely(const LocalInput& input, const std::vector<char>& is_fixed) {
  if (input.likely.is_fixed.size() != is_fixed.size()) return false;
  for (std::size_t i = 0; i < is_fixed.size(); ++i)
    if (is_fixed[i] != input.likely.is_fixed[i] && input.is_dirty[i] == 0) return false;
  return true;
}

/// Decides the strata of lone seeds, and finds the layers of what they leave.
std::vector<std::uint32_t> decideLoneSeeds(const LocalInput& input, double reach_m, ReasoningState& state) {
  const auto later = state.rules.strata.begin() + static_cast<std::ptrdiff_t>(strataOfLoneSeeds(state.rules));
  std::for_each(state.rules.strata.begin(), later, [&](const auto& stratum) { decideStratum(state, stratum); });
  const std::vector<char> is_fixed = fixedPrimitives(state);
  if (areLikely(input, is_fixed)) return input.likely.layers;
  return layersAround(input.window, input.is_dirty, is_fixed, input.gone, reach_m);
}

}  // namespace

LocalRun::LocalRun(const LocalInput& input, const RuleSet& rules, const ReasoningContext& context, double reach_m)
    : input_(input),
      rules_(rules),
      state_(std::make_unique<ReasoningState>(input.window, rules, context)),
      layers_(decideLoneSeeds(input, reach_m, *state_)) {
  assert(!rules.asks_map);
}

LocalRun::~LocalRun() = default;

std::optional<LocalOutcome> LocalRun::decide() {
  LocalOutcome outcome;
  outcome.layer = layers_;
  if (std::all_of(layers_.begin(), layers_.end(), [](std::uint32_t layer) { return layer == kNoLayer; }))
    return outcome;
  const SeamSearch seams(input_, layers_);
  if (!seams.mayFind()) return std::nullopt;
  state_->trace.useLayers(layers_);
  const auto later = rules_.strata.begin() + static_cast<std::ptrdiff_t>(strataOfLoneSeeds(rules_));
  std::for_each(later, rules_.strata.end(), [&](const auto& stratum) { decideStratum(*state_, stratum); });
  outcome.result = finishedRun(*state_);
  outcome.seams = seams.find(outcome.result, state_->trace.spans());
  if (outcome.seams.empty()) return std::nullopt;
  return outcome;
}

std::optional<LocalOutcome> decideLocally(const LocalInput& input, const RuleSet& rules,
                                          const ReasoningContext& context, double reach_m) {
  return LocalRun(input, rules, context, reach_m).decide();
}

}  // namespace cluxel::rules
