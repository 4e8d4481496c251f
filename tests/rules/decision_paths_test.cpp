// SPDX-License-Identifier: Apache-2.0
// Runs that leave out how decisions were taken decide the same.
#include <gtest/gtest.h>

#include <tuple>

#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace rules;
namespace {

/// A run of the shipped rules over a street, with paths and without.
struct BothRuns {
  perception::Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  RuleSet rules = outdoorRules();
  ReasoningResult with = reason(scene, rules), without = reason(scene, rules, {.keeps_paths = false});
};

TEST(DecisionPaths, LeftOutGiveTheSameObjectsAndTraces) {
  const BothRuns runs;
  EXPECT_EQ(runs.without.traces, runs.with.traces);
  ASSERT_EQ(runs.without.objects.size(), runs.with.objects.size());
  for (std::size_t i = 0; i < runs.with.objects.size(); ++i) {
    const SemanticObject &one = runs.with.objects[i], &other = runs.without.objects[i];
    EXPECT_EQ(std::tie(one.id, one.class_iri, one.rule_id, one.confidence, one.decision),
              std::tie(other.id, other.class_iri, other.rule_id, other.confidence, other.decision));
  }
}

TEST(DecisionPaths, LeftOutGiveTheSameDecisionsWithoutWords) {
  const BothRuns runs;
  ASSERT_EQ(runs.without.decisions.size(), runs.with.decisions.size());
  bool had_path = false, had_evidence = false;
  for (std::size_t i = 0; i < runs.with.decisions.size(); ++i) {
    const Decision &one = runs.with.decisions[i], &other = runs.without.decisions[i];
    EXPECT_EQ(std::tie(one.rule_id, one.seeds, one.accepted, one.leaf, one.log_odds, one.probability),
              std::tie(other.rule_id, other.seeds, other.accepted, other.leaf, other.log_odds, other.probability));
    had_path = had_path || !one.path.empty();
    had_evidence = had_evidence || !one.evidence.empty();
    EXPECT_TRUE(other.path.empty() && other.evidence.empty() && other.reason.empty() && other.hint.empty());
  }
  EXPECT_TRUE(had_path && had_evidence);
}

}  // namespace
}  // namespace cluxel::testing
