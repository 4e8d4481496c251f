// SPDX-License-Identifier: Apache-2.0
// Every line that explains an accepted candidate holds when it is evaluated again: attributes, slices,
// pairs, relations, finds and evidence. Measures come from brute force over all cluxels, not from the rules' own code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rules/box_world.hpp"
#include "rules/brute_force_measures.hpp"
#include "rules/decide/decision_record.hpp"
#include "rules/propose/condition_eval.hpp"
#include "rules/propose/unseen_ends.hpp"
#include "rules/testing/rule_test_file.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

constexpr double kSame = 1e-6;  // of SI units and log-odds

struct Counts {
  std::size_t unseen = 0, attributes = 0, slices = 0, pairs = 0, relations = 0, labels = 0, finds = 0, evidence = 0;
};

/// What was said of one accepted candidate, against brute force.
class LinesOfACandidate {
 public:
  LinesOfACandidate(const ReasoningState& state, const Rule& rule, const Verdict& verdict, Counts& counts)
      : state_(state), rule_(rule), verdict_(verdict), counts_(counts), brute_(state, verdict.bindings) {}

  void check() {
    for (const DecisionStep& step : verdict_.decision.path)
      if (!step.test.starts_with("finds ")) checkStep(step);
    for (const TreeNode& node : rule_.nodes)
      if (const auto* find = std::get_if<FindNode>(&node.what)) checkFind(*find);
    checkEvidence();
  }

 private:
  static void collect(const Condition& condition, std::vector<const Condition*>& all) {
    const bool negative = condition.kind == Condition::Kind::Not && condition.operands.front().operands.empty();
    const bool single = negative || condition.operands.empty() || condition.kind == Condition::Kind::Unseen;
    if (single) all.push_back(&condition);
    if (!single)
      for (const Condition& operand : condition.operands) collect(operand, all);
  }

  /// The test of the rule's tree that has these words.
  const Condition* conditionOf(const DecisionStep& step) const {
    std::vector<const Condition*> all;
    for (const TreeNode& node : rule_.nodes)
      if (const auto* branch = std::get_if<BranchNode>(&node.what)) collect(branch->condition, all);
    const auto found = std::find_if(all.begin(), all.end(), [&](const Condition* condition) {
      return describe(*condition) == step.test && condition->at.line == step.line;
    });
    return found == all.end() ? nullptr : *found;
  }

  void checkStep(const DecisionStep& step) {
    const Condition* condition = conditionOf(step);
    if (condition == nullptr) {
      ADD_FAILURE() << rule_.id << ": '" << step.test << "' is no test of the rule";
      return;
    }
    const bool negative = condition->kind == Condition::Kind::Not;
    const Condition& inner = negative ? condition->operands.front() : *condition;
    if (const auto holds = evaluate(inner, step.measured)) {
      EXPECT_EQ(*holds != negative, step.passed) << rule_.id << ": " << step.test;
    }
  }

  void expectTold(const Condition& condition, std::optional<double> value, std::optional<double> told) const {
    if (told) {
      EXPECT_NEAR(value.value_or(-1), *told, kSame) << rule_.id << ": " << describe(condition);
    }
  }

  /// Absent for what brute force cannot measure: the shape of a slice.
  std::optional<bool> evaluate(const Condition& condition, std::optional<double> told) {
    using Kind = Condition::Kind;
    if (condition.kind == Kind::Label) {
      ++counts_.labels;
      const auto& fragments = verdict_.bindings.at(condition.of).fragments;
      if (condition.value) {
        const double share = brute_.labelShare(condition);
        expectTold(condition, share, told);
        return compare(condition, share, condition.value->value);
      }
      return std::all_of(fragments.begin(), fragments.end(), [&](FragmentIndex fragment) {
        return std::find(condition.labels.begin(), condition.labels.end(), state_.fragments.labelOf(fragment)) !=
               condition.labels.end();
      });
    }
    if (condition.kind == Kind::Attribute) return evaluateAttribute(condition, told, 0);
    if (condition.kind == Kind::Unseen) return evaluateUnseen(condition.operands.front());
    if (condition.kind == Kind::Pair) {
      ++counts_.pairs;
      const auto value = brute_.pair(condition);
      expectTold(condition, value, told);
      if (!value)
        return condition.comparison == Comparison::GreaterEqual || condition.comparison == Comparison::Greater;
      return compare(condition, *value, condition.value->value);
    }
    if (condition.kind == Kind::Relation) {
      ++counts_.relations;
      const auto value = brute_.relation(condition);
      expectTold(condition, value, told);
      return value && (!condition.value || *value <= condition.value->value);
    }
    ADD_FAILURE() << "no brute force for " << describe(condition);
    return std::nullopt;
  }

  /// Unseen: things that go on farther at their unseen ends would be judged otherwise.
  std::optional<bool> evaluateUnseen(const Condition& test) {
    std::optional<bool> as_measured;
    for (const double farther_m : {0.0, 0.1, 0.5, 1.0, 2.0, 4.0, 8.0, 100.0}) {
      const std::optional<bool> holds = evaluateExtended(test, farther_m);
      if (!holds) return std::nullopt;
      if (!as_measured) as_measured = holds;
      if (*holds == *as_measured) continue;
      ++counts_.unseen;
      return true;
    }
    return false;
  }

  std::optional<bool> evaluateExtended(const Condition& condition, double farther_m) {
    using Kind = Condition::Kind;
    if (condition.kind == Kind::Attribute)
      return evaluateAttribute(condition, std::nullopt, isUnseen(condition) ? farther_m : 0);
    if (condition.kind != Kind::All && condition.kind != Kind::Any && condition.kind != Kind::Not)
      return evaluate(condition, std::nullopt);
    bool all = true, any = false;
    for (const Condition& operand : condition.operands) {
      const std::optional<bool> holds = evaluateExtended(operand, farther_m);
      if (!holds) return std::nullopt;
      all = all && *holds, any = any || *holds;
    }
    return condition.kind == Kind::All ? all : condition.kind == Kind::Any ? any : !all;
  }

  /// Tops by brute force: every view's edge is less than 0.4 degrees above the highest cluxel.
  bool isUnseen(const Condition& condition) const {
    if (condition.slice || !isOfAnEnd(condition.attribute)) return false;
    const Candidate& candidate = verdict_.bindings.at(condition.of);
    if (condition.attribute != Attribute::Top) return isEndUnseen(state_, candidate, condition.attribute);
    const SceneCluxels& all = state_.scene.cluxels;
    bool unseen = !state_.scene.views.empty();
    for (const SceneView& view : state_.scene.views) {
      double highest = -1e9;
      for (std::uint32_t cluxel : state_.fragments.cluxelsOf(candidate)) {
        const Eigen::Vector3d from = all.center[cluxel] - view.T_map_sensor.translation();
        const double top = from.z() + static_cast<double>(all.extent[cluxel].z()) / 2;
        if (all.center[cluxel].z() + static_cast<double>(all.extent[cluxel].z()) / 2 > candidate.shape.max.z() - 0.01)
          highest = std::max(highest, std::atan(top / std::hypot(from.x(), from.y())));
      }
      unseen = unseen && view.sight.upper_edge && view.sight.upper_edge->mean_rad - highest < 0.4 * 3.14159265 / 180;
    }
    return unseen;
  }

  std::optional<bool> evaluateAttribute(const Condition& condition, std::optional<double> told, double farther_m) {
    const auto value = brute_.attribute(condition.of, condition.slice, condition.attribute);
    const bool measurable = value || !condition.slice;
    if (measurable) expectTold(condition, value, told);
    if (!measurable && !told) return std::nullopt;
    const double measured = value ? *value : *told;  // the extent of a slice is taken from the rules' own measure
    double threshold = condition.value ? condition.value->value : 0;
    if (condition.ratio_attribute) {
      const auto other = brute_.attribute(condition.ratio_of, condition.ratio_slice, *condition.ratio_attribute);
      if (!other) return std::nullopt;
      threshold = condition.ratio * *other;
    }
    ++(condition.slice ? counts_.slices : counts_.attributes);
    return compare(condition, condition.attribute == Attribute::Bottom ? measured - farther_m : measured + farther_m,
                   threshold);
  }

  /// What was found passes each condition by itself, when it is one fragment.
  void checkFind(const FindNode& find) {
    const auto found = std::find_if(verdict_.bindings.candidates.begin(), verdict_.bindings.candidates.end(),
                                    [&](const auto& bound) { return bound.first == find.name; });
    if (found == verdict_.bindings.candidates.end() || found->second.fragments.size() != 1) return;
    ++counts_.finds;
    for (const Condition& condition : find.where)
      if (condition.operands.empty()) {
        const auto holds = evaluate(condition, std::nullopt);
        EXPECT_TRUE(holds.value_or(true)) << rule_.id << ": " << find.name << " with " << describe(condition);
      }
  }

  void checkEvidence() {
    const Decision& decision = verdict_.decision;
    std::vector<const EvidenceLine*> lines;
    for (const auto* list : {&rule_.evidence, &verdict_.accept->evidence})
      for (const EvidenceLine& line : *list) lines.push_back(&line);
    ASSERT_EQ(decision.evidence.size(), lines.size() + 1) << rule_.id;
    double sum = std::log(*decision.evidence[0].measured / (1 - *decision.evidence[0].measured));
    EXPECT_NEAR(decision.evidence[0].log_odds, sum, kSame);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const EvidenceStep& step = decision.evidence[i + 1];
      EXPECT_EQ(step.line, lines[i]->at.line);
      EXPECT_NEAR(step.log_odds, addedBy(*lines[i], step), kSame) << rule_.id << ": " << step.text;
      sum += step.log_odds;
      ++counts_.evidence;
    }
    EXPECT_NEAR(decision.log_odds, sum, kSame) << rule_.id;
    EXPECT_NEAR(decision.probability, 1 / (1 + std::exp(-sum)), kSame) << rule_.id;
  }

  static double addedBy(const EvidenceLine& line, const EvidenceStep& step) {
    if (line.kind == EvidenceLine::Kind::Test) return step.holds.value_or(false) ? line.weight : 0;
    if (!step.measured) return line.missing;
    double added = line.knots.front().log_odds;
    for (std::size_t i = 1; i < line.knots.size(); ++i) {
      const auto &from = line.knots[i - 1], &to = line.knots[i];
      const double share = std::clamp((*step.measured - from.at) / (to.at - from.at), 0.0, 1.0);
      added += share * (to.log_odds - from.log_odds);
    }
    return added;
  }

  const ReasoningState& state_;
  const Rule& rule_;
  const Verdict& verdict_;
  Counts& counts_;
  BruteForce brute_;
};

TEST(ExplanationLines, HoldWhenEvaluatedAgainByBruteForce) {
  const RuleTestFile file =
      readRuleTestFile(test::sourceFolder() / "rules/outdoor.rules-test.yaml", outdoorCatalogue(), {});
  std::vector<BoxScene> scenes{streetOfBoxes()};
  for (const RuleTest& test : file.tests)
    if (!test.scene) scenes.push_back(test.boxes);
  Counts counts;
  for (const BoxScene& boxes : scenes) {
    const BuiltBoxScene built = sceneOfBoxes(boxes);
    ReasoningContext context;
    context.onCandidate = [&](const ReasoningState& state, const Rule& rule, const Verdict& verdict) {
      if (!rule.seed.slice) LinesOfACandidate(state, rule, verdict, counts).check();
    };
    reason(built.scene, file.rules, context);
  }
  EXPECT_GT(counts.unseen, 3U);
  EXPECT_GT(counts.attributes, 1000U);
  EXPECT_GT(counts.slices, 20U);
  EXPECT_GT(counts.pairs, 50U);
  EXPECT_GT(counts.relations, 3U);
  EXPECT_GT(counts.labels, 5U);
  EXPECT_GT(counts.finds, 30U);
  EXPECT_GT(counts.evidence, 500U);
}

}  // namespace
}  // namespace cluxel::testing
