// SPDX-License-Identifier: Apache-2.0
// Every line of an explanation holds when it is evaluated again from the map: the tests in words, their measures, and
// the way through the tree. And the rule of another class that comes nearest is told with what it misses.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cluxel/error.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "rules/decide/reasoning_state.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/explain/why_not.hpp"
#include "rules/language/rule_loader.hpp"
#include "rules/language/rule_reading.hpp"
#include "rules/propose/condition_eval.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/explanation.hpp"

namespace cluxel::tasks {

using namespace mapping;
namespace {

using ::testing::HasSubstr;

struct Reasoned {
  RuleSet rules;
  ReasoningResult result;
};

const Reasoned& reasoned() {
  static const Reasoned made = [] {
    const MapReader& map = CampusMap::shared().map();
    const MapInputs inputs = map.inputs();
    std::vector<RuleSource> sources;
    for (const NamedText& text : inputs.rules) sources.push_back({text.name, text.text});
    Reasoned all{loadRuleTexts(sources, inputs.rule_roots, classCatalogueOf(inputs.ontology)).require(), {}};
    AskReplay oracle(map);
    all.result = reason(map.scene(), all.rules, {.oracle = &oracle});
    return all;
  }();
  return made;
}

/// The words of a step as a condition about the seed; absent when they are about something else too.
std::optional<Condition> conditionOfStep(const DecisionStep& step, const Rule& rule) {
  FaultList faults("step", step.test);
  const RuleLoadOptions options;
  RuleReading reading{reasoned().rules.catalogue, options, faults};
  reading.prefixes = reasoned().rules.prefixes;
  YamlNode text;
  text.kind = YamlNode::Kind::Scalar;
  text.at.line = text.at.column = 1;
  text.text = step.test;
  auto condition = readCondition(text, {{rule.seed.name}, rule.seed.name}, reading);
  if (faults.errorCount() > 0 || !condition) return std::nullopt;
  const Condition& inner = condition->kind == Condition::Kind::Not ? condition->operands.front() : *condition;
  if (inner.kind != Condition::Kind::Attribute && inner.kind != Condition::Kind::Label) return std::nullopt;
  return condition;
}

TEST(ExplanationTruth, EveryLineAboutAThingItselfHoldsInTheMap) {
  const perception::Scene& scene = CampusMap::shared().map().scene();
  const ReasoningContext context;
  const ReasoningState state(scene, reasoned().rules, context);
  std::size_t checked = 0;
  for (const Decision& decision : reasoned().result.decisions) {
    const Rule& rule = *reasoned().rules.find(decision.rule_id);
    if (rule.seed.slice) continue;  // its seeds are pieces that are put back
    std::vector<FragmentIndex> fragments;
    for (const perception::PrimitiveIndex seed : decision.seeds)
      for (const FragmentIndex fragment : state.fragments.fragmentsOf(seed)) fragments.push_back(fragment);
    Bindings bindings;
    bindings.candidates.emplace_back(rule.seed.name, state.fragments.candidateOf(fragments));
    // A primitive that was split has become smaller since: only whole ones can be measured again.
    const double points = bindings.at(rule.seed.name).shape.points;
    for (const DecisionStep& step : decision.path) {
      const auto condition = conditionOfStep(step, rule);
      if (!condition) continue;
      ConditionEvaluator evaluator(state, rule, bindings);
      std::vector<DecisionStep> again;
      const bool holds = evaluator.holds(*condition, &again);
      const bool same_thing =
          !step.measured || !again.front().measured || std::abs(*step.measured - *again.front().measured) < 1e-9;
      if (!same_thing && rule.leftovers) continue;
      EXPECT_TRUE(same_thing) << decision.rule_id << ": " << step.test << " of " << points << " points";
      EXPECT_EQ(holds, step.passed) << decision.rule_id << ": " << step.test;
      ++checked;
    }
  }
  EXPECT_GT(checked, 500U);
}

TEST(ExplanationTruth, TheWayThroughTheTreeEndsAtTheLeafThatWasTold) {
  for (const Decision& decision : reasoned().result.decisions) {
    const Rule& rule = *reasoned().rules.find(decision.rule_id);
    const auto walked = walkedPath(rule, decision);
    if (decision.is_gathered) {  // the object that gathers it came to the leaf
      EXPECT_TRUE(walked.empty());
      continue;
    }
    NodeIndex leaf = 0;
    if (!walked.empty()) {
      const auto& last = walked.back();
      const auto* branch = std::get_if<BranchNode>(&rule.nodes[last.node].what);
      const auto* find = std::get_if<FindNode>(&rule.nodes[last.node].what);
      if (branch != nullptr) leaf = last.tests.passed ? branch->yes : branch->no;
      if (find != nullptr) leaf = last.tests.passed ? find->found : find->missing;
    }
    EXPECT_EQ(leaf, decision.leaf) << decision.rule_id;
  }
}

/// The measured values of the nearest rule, moved as it says, would turn its tests.
TEST(WhyNot, TellsTheNearestRuleOfAClassFirst) {
  const MapReader& map = CampusMap::shared().map();
  std::size_t told = 0;
  for (const SemanticObject& object : map.objects()) {
    if (localName(object.class_iri) != "StreetSign" && localName(object.class_iri) != "StreetLamp") continue;
    if (++told > 3) break;
    const auto json = nlohmann::json::parse(explainWhyNot(map, object.id.hex(), "Tree").json);
    EXPECT_EQ(json.at("class"), "clx:Tree");
    ASSERT_FALSE(json.at("rules").empty());
    const std::vector<std::string> order{"accepted", "changeable", "rejected", "no seed", "other label"};
    std::size_t last = 0;
    for (const auto& rule : json.at("rules")) {
      const auto place = std::find(order.begin(), order.end(), rule.at("outcome").get<std::string>());
      ASSERT_NE(place, order.end());
      EXPECT_GE(static_cast<std::size_t>(place - order.begin()), last);
      last = static_cast<std::size_t>(place - order.begin());
      if (!rule.contains("least_change")) continue;
      for (const auto& change : rule.at("least_change").at("changes"))
        EXPECT_NEAR(std::abs(change.at("measured").get<double>() - change.at("threshold").get<double>()),
                    change.at("margin").get<double>(), 1e-9);
    }
  }
  EXPECT_GT(told, 0U);
}

TEST(WhyNot, OfItsOwnClassIsAcceptedByTheRuleThatMadeIt) {
  const MapReader& map = CampusMap::shared().map();
  std::size_t told = 0;
  for (const SemanticObject& object : map.objects()) {
    if (localName(object.class_iri) != "StreetSign" || ++told > 3) continue;
    const ExplanationTexts why = explainWhyNot(map, object.id.hex(), "StreetSign");
    EXPECT_THAT(why.text, HasSubstr(object.rule_id + ": accepted with log-odds "));
    EXPECT_THAT(why.text, HasSubstr(": it made the thing\n"));
    const auto json = nlohmann::json::parse(why.json);
    EXPECT_EQ(json.at("rules").at(0).at("outcome"), "accepted");
    EXPECT_EQ(json.at("rules").at(0).at("rule"), object.rule_id);
  }
  EXPECT_GT(told, 0U);
}

TEST(WhyNot, RefusesAClassThatNobodyKnows) {
  const MapReader& map = CampusMap::shared().map();
  EXPECT_THROW(explainWhyNot(map, "#0", "Tre"), Error);
  EXPECT_THAT(explainWhyNot(map, "#0", "clx:Tree").text, HasSubstr("why not clx:Tree:"));
}

TEST(ExplanationGraph, DrawsEveryNodeOfTheRuleAndTheWayInBold) {
  const MapReader& map = CampusMap::shared().map();
  const std::string dot = explanationGraph(map, "#0", "");
  EXPECT_THAT(dot, HasSubstr("digraph \""));
  EXPECT_THAT(dot, HasSubstr("style=bold"));
  EXPECT_TRUE(dot.ends_with("}\n"));
}

}  // namespace
}  // namespace cluxel::tasks
