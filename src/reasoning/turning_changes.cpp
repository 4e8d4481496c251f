// SPDX-License-Identifier: Apache-2.0
// Walks a condition beside its steps: an `all` that held turns when its closest test does, one that failed when all of
// its failed tests do; an `any` the other way round.
#include "reasoning/turning_changes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel {

namespace {

using Changes = std::optional<std::vector<NeededChange>>;

/// What a part of the condition gave, and what would turn it.
struct Outcome {
  bool holds = false;
  Changes turn;
};

Changes changeOf(const DecisionStep& step) {
  if (!step.measured || !step.threshold) return std::nullopt;
  const double scale = step.unit == "rad" ? 180.0 / std::numbers::pi : 1.0;
  NeededChange change;
  change.test = step.test;
  change.measured = *step.measured * scale;
  change.threshold = *step.threshold * scale;
  change.unit = step.unit == "rad" ? "deg" : step.unit;
  change.margin = std::abs(change.measured - change.threshold);
  return std::vector{change};
}

class TurningWalk {
 public:
  TurningWalk(const std::vector<DecisionStep>& path, std::size_t first_step) : path_(path), at_(first_step) {}

  /// Takes the steps of the condition off the path, as ConditionEvaluator put them there.
  Outcome of(const Condition& condition) {
    using Kind = Condition::Kind;
    if (condition.kind == Kind::All || condition.kind == Kind::Any) return ofSeveral(condition);
    if (condition.kind == Kind::Not && !condition.operands.front().operands.empty()) {
      Outcome outcome = of(condition.operands.front());
      outcome.holds = !outcome.holds;
      return outcome;
    }
    const DecisionStep& step = path_.at(at_++);
    return {step.passed, changeOf(step)};
  }

 private:
  Outcome ofSeveral(const Condition& condition) {
    const bool all = condition.kind == Condition::Kind::All;
    bool holds = all, unasked = false;
    std::vector<Outcome> operands;
    for (const Condition& operand : condition.operands) {
      if (operand.kind == Condition::Kind::Ask && holds != all) {
        unasked = true;
        continue;
      }
      operands.push_back(of(operand));
      holds = all ? holds && operands.back().holds : holds || operands.back().holds;
    }
    if (holds == all) return {holds, closest(operands)};
    return {holds, unasked ? std::nullopt : together(operands, holds)};
  }

  static Changes closest(const std::vector<Outcome>& operands) {
    Changes best;
    for (const Outcome& operand : operands)
      if (operand.turn && (!best || costOf(*operand.turn) < costOf(*best))) best = operand.turn;
    return best;
  }

  /// The changes of all operands that gave `holds`.
  static Changes together(const std::vector<Outcome>& operands, bool holds) {
    std::vector<NeededChange> all;
    for (const Outcome& operand : operands) {
      if (operand.holds != holds) continue;
      if (!operand.turn) return std::nullopt;
      all.insert(all.end(), operand.turn->begin(), operand.turn->end());
    }
    return all;
  }

  const std::vector<DecisionStep>& path_;
  std::size_t at_;
};

}  // namespace

double costOf(const std::vector<NeededChange>& changes) {
  double cost = 0;
  for (const NeededChange& change : changes) cost += change.margin / std::max(std::abs(change.threshold), 0.05);
  return cost;
}

std::optional<std::vector<NeededChange>> changesThatTurn(const Condition& condition,
                                                         const std::vector<DecisionStep>& path,
                                                         std::size_t first_step) {
  return TurningWalk(path, first_step).of(condition).turn;
}

}  // namespace cluxel
