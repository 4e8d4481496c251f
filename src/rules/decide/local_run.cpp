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

}  // namespace

LocalRun::LocalRun(const LocalInput& input, const RuleSet& rules, const ReasoningContext& context, double reach_m)
    : rules_(rules), state_(std::make_unique<ReasoningState>(input.window, rules, context)) {
  assert(!rules.asks_map);
  for (const std::vector<std::string>& stratum : dividedStrata(rules).lone) decideStratum(*state_, stratum);
  is_fixed_ = fixedPrimitives(*state_);
  std::vector<std::uint32_t> layers = areLikely(input, is_fixed_)
                                          ? input.likely.layers
                                          : layersAround(input.window, input.is_dirty, is_fixed_, input.gone, reach_m);
  seam_ = std::make_unique<SeamSearch>(input, is_fixed_, reach_m, std::move(layers));
}

LocalRun::~LocalRun() = default;

const std::vector<std::uint32_t>& LocalRun::layers() const {
  return seam_->layers();
}

bool LocalRun::decide() {
  if (std::all_of(layers().begin(), layers().end(), [](std::uint32_t layer) { return layer == kNoLayer; })) return true;
  return findSeam();
}

bool LocalRun::decideWith(std::span<const perception::PrimitiveIndex> changed) {
  return seam_->addChanged(changed) && findSeam();
}

bool LocalRun::findSeam() {
  if (!seam_->isInWindow()) return false;
  if (!std::exchange(has_run_, true)) {
    state_->trace.keepMembers();
    for (const std::vector<std::string>& stratum : dividedStrata(rules_).later) decideStratum(*state_, stratum);
    result_ = finishedRun(*state_);
  }
  return seam_->find(result_.traces, state_->trace.steps());
}

std::optional<LocalOutcome> decideLocally(const LocalInput& input, const RuleSet& rules,
                                          const ReasoningContext& context, double reach_m) {
  LocalRun run(input, rules, context, reach_m);
  if (!run.decide()) return std::nullopt;
  return LocalOutcome{run.takeResult(), run.layers()};
}

}  // namespace cluxel::rules
