// SPDX-License-Identifier: Apache-2.0
// Evaluates a condition tree bottom-up for the cheapest change of its outcome. To flip an `all` that holds, or an `any`
// that fails, one operand must flip: take the cheapest. To flip an `all` that fails, or an `any` that holds, every
// operand with that outcome must flip: take all.
#include "rules/explain/counterfactuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rules/propose/condition_eval.hpp"

namespace cluxel::rules {

namespace {

using Turns = std::optional<std::vector<TurnedTest>>;

/// The outcome of a condition and the tests whose turn flips it.
struct Outcome {
  bool holds = false;
  Turns turn;
};

/// The value nearest to the threshold for which the test has the outcome.
double nearestWith(bool outcome, const Condition& test, double threshold) {
  const bool is_interval = test.comparison == Comparison::Between || test.comparison == Comparison::Outside;
  const double compared = is_interval ? test.value->value : threshold;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {std::nextafter(threshold, infinity), std::nextafter(threshold, -infinity)})
    if (compare(test, threshold, compared) != outcome && compare(test, value, compared) == outcome) return value;
  return threshold;  // which has the outcome itself, as 6 m has that of >= 6 m
}

double costOf(const std::vector<TurnedTest>& turns) {
  std::vector<NeededChange> changes;
  for (const TurnedTest& turn : turns) changes.push_back(turn.change);
  return rules::costOf(changes);
}

Turns turnOf(const Condition& condition, const DecisionStep& step) {
  if (!step.measured || !step.threshold) return std::nullopt;
  const double scale = step.unit == "rad" ? 180.0 / std::numbers::pi : 1.0;
  NeededChange change;
  change.test = step.test;
  change.measured = *step.measured * scale;
  change.threshold = *step.threshold * scale;
  change.unit = step.unit == "rad" ? "deg" : step.unit;
  change.margin = std::abs(change.measured - change.threshold);
  const bool is_negated = condition.kind == Condition::Kind::Not;
  const Condition& test = is_negated ? condition.operands.front() : condition;
  const double value = nearestWith(step.passed == is_negated, test, *step.threshold);
  return std::vector{TurnedTest{&test, *step.measured, value, std::move(change)}};
}

class CounterfactualWalk {
 public:
  CounterfactualWalk(const std::vector<DecisionStep>& path, std::size_t first_step) : path_(path), at_(first_step) {}

  /// Consumes the condition's steps of the path, in the order in which ConditionEvaluator wrote them.
  Outcome of(const Condition& condition) {
    using Kind = Condition::Kind;
    if (condition.kind == Kind::All || condition.kind == Kind::Any) return ofSeveral(condition);
    if (condition.kind == Kind::Not && !condition.operands.front().operands.empty()) {
      Outcome outcome = of(condition.operands.front());
      outcome.holds = !outcome.holds;
      return outcome;
    }
    const DecisionStep& step = path_.at(at_++);
    return {step.passed, turnOf(condition, step)};
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

  static Turns closest(const std::vector<Outcome>& operands) {
    Turns best;
    for (const Outcome& operand : operands)
      if (operand.turn && (!best || costOf(*operand.turn) < costOf(*best))) best = operand.turn;
    return best;
  }

  /// The changes of all operands whose outcome is `holds`; absent when one of them cannot be flipped.
  static Turns together(const std::vector<Outcome>& operands, bool holds) {
    std::vector<TurnedTest> all;
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

std::optional<std::vector<TurnedTest>> leastTurns(const Condition& condition, const std::vector<DecisionStep>& path,
                                                  std::size_t first_step) {
  return CounterfactualWalk(path, first_step).of(condition).turn;
}

std::optional<std::vector<NeededChange>> counterfactualChanges(const Condition& condition,
                                                               const std::vector<DecisionStep>& path,
                                                               std::size_t first_step) {
  const auto turns = leastTurns(condition, path, first_step);
  if (!turns) return std::nullopt;
  std::vector<NeededChange> changes;
  for (const TurnedTest& turn : *turns) changes.push_back(turn.change);
  return changes;
}

}  // namespace cluxel::rules
