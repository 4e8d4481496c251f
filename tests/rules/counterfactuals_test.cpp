// SPDX-License-Identifier: Apache-2.0
// The counterfactual against trying every set of tests, on random conditions.
#include "rules/explain/counterfactuals.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cluxel::rules {

using namespace scan;
using namespace perception;
namespace {

using Kind = Condition::Kind;

/// A random condition with its steps, as the evaluator would have written them.
class RandomCondition {
 public:
  explicit RandomCondition(unsigned seed) : random_(seed) { condition = make(3); }
  Condition condition;
  std::vector<DecisionStep> path;

 private:
  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

  Condition make(int depth) {
    Condition made;
    const int kind = depth == 0 ? 0 : below(4);
    if (kind == 0) {
      made.kind = Kind::Attribute;
      DecisionStep step;
      step.test = "t" + std::to_string(path.size());
      step.passed = below(2) == 0;
      if (below(8) != 0) {  // else a label: nothing to change
        step.threshold = 1 + below(5);
        step.measured = *step.threshold + 0.25 * (1 + below(8));
      }
      path.push_back(step);
      return made;
    }
    made.kind = kind == 1 ? Kind::All : kind == 2 ? Kind::Any : Kind::Not;
    if (made.kind == Kind::Not) {
      Condition inner;
      inner.kind = below(2) == 0 ? Kind::All : Kind::Any;
      for (int i = 0, count = 1 + below(3); i < count; ++i) inner.operands.push_back(make(depth - 1));
      made.operands.push_back(std::move(inner));
      return made;
    }
    for (int i = 0, count = 1 + below(3); i < count; ++i) made.operands.push_back(make(depth - 1));
    return made;
  }

  std::mt19937 random_;
};

bool valueOf(const Condition& condition, const std::vector<bool>& passed, std::size_t& at) {
  if (condition.kind == Kind::Attribute) return passed[at++];
  if (condition.kind == Kind::Not) return !valueOf(condition.operands.front(), passed, at);
  bool value = condition.kind == Kind::All;
  for (const Condition& operand : condition.operands) {
    const bool one = valueOf(operand, passed, at);
    value = condition.kind == Kind::All ? value && one : value || one;
  }
  return value;
}

bool valueOf(const Condition& condition, const std::vector<bool>& passed) {
  std::size_t at = 0;
  return valueOf(condition, passed, at);
}

/// The smallest cost of a set of measured tests that flips the condition; infinity when there is none.
double leastByTrying(const RandomCondition& made) {
  std::vector<bool> now;
  for (const DecisionStep& step : made.path) now.push_back(step.passed);
  double best = std::numeric_limits<double>::infinity();
  for (std::uint32_t set = 1; set < 1U << now.size(); ++set) {
    std::vector<bool> turned = now;
    double cost = 0;
    bool possible = true;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if ((set >> i & 1U) == 0) continue;
      turned[i] = !now[i];
      const DecisionStep& step = made.path[i];
      possible = possible && step.measured;
      if (step.measured) cost += (*step.measured - *step.threshold) / *step.threshold;
    }
    if (possible && cost < best && valueOf(made.condition, turned) != valueOf(made.condition, now)) best = cost;
  }
  return best;
}

TEST(Counterfactuals, AreTheLeastThatTurnAnyCondition) {
  int turnable = 0, compared = 0;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    const RandomCondition made(seed);
    if (made.path.size() > 12) continue;
    ++compared;
    const auto changes = counterfactualChanges(made.condition, made.path, 0);
    const double best = leastByTrying(made);
    ASSERT_EQ(changes.has_value(), best < std::numeric_limits<double>::infinity()) << "seed " << seed;
    if (!changes) continue;
    ++turnable;
    EXPECT_NEAR(costOf(*changes), best, 1e-9) << "seed " << seed;
  }
  EXPECT_GT(compared, 2000);
  EXPECT_GT(turnable, 1000);
}

TEST(Counterfactuals, AreNotPromisedWhereAQueryWasNotAsked) {
  DecisionStep failed;
  failed.measured = 1, failed.threshold = 2;
  Condition test, ask, all;
  test.kind = Kind::Attribute, ask.kind = Kind::Ask, all.kind = Kind::All;
  all.operands = {test, ask};
  EXPECT_FALSE(counterfactualChanges(all, {failed}, 0).has_value());
  all.operands = {test};
  EXPECT_TRUE(counterfactualChanges(all, {failed}, 0).has_value());
}

}  // namespace
}  // namespace cluxel::rules
