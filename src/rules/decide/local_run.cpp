// SPDX-License-Identifier: Apache-2.0
// Runs the rules over a window and looks for a seam.
#include "rules/decide/local_run.hpp"

#include <algorithm>
#include <cassert>

#include "rules/decide/reasoning_strata.hpp"
#include "rules/decide/seam_search.hpp"

namespace cluxel::rules {

namespace {

/// Whether the likely layers hold. Dirty primitives are in layer 0, fixed or not.
bool areLikely(const LocalInput& input, const std::vector<char>& is_fixed) {
  if (input.likely.is_fixed.size() != is_fixed.size()) return false;
  for (std::size_t i = 0; i < is_fixed.size(); ++i)
    if (is_fixed[i] != input.likely.is_fixed[i] && input.is_dirty[i] == 0) return false;
  return true;
}

/// Decides the strata of lone seeds, and finds the layers of what they leave.
std::vector<std::uint32_t> decideLoneSeeds(const LocalInput& input, double reach_m, ReasoningState& state) {
  for (const std::vector<std::string>& stratum : dividedStrata(state.rules).lone) decideStratum(state, stratum);
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
  for (const std::vector<std::string>& stratum : dividedStrata(rules_).later) decideStratum(*state_, stratum);
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
