// SPDX-License-Identifier: Apache-2.0
// Following a change gives the facts, and the record for the next change, that inference from scratch gives.
#include "mapping/changing_store.hpp"
#include "mapping/inference/rule_shape.hpp"
#include "mapping/rules_of_shapes.hpp"

namespace cluxel::mapping {

namespace {

TEST(InferChanges, OfShippedRulesAreInferenceFromScratch) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    ChangingStore store(seed, shippedInputs().sparql_rules);
    const int steps = stepsOf(40, 600);
    for (int step = 0; step < steps && !testing::Test::HasFatalFailure(); ++step) {
      store.step();
      store.expectInferenceFromScratch(step);
    }
    EXPECT_GT(store.followed(), static_cast<std::size_t>(steps) * 3 / 4) << "few state something of a derivation";
    EXPECT_TRUE(store.sink.notes.empty()) << store.sink.notes.front();
  }
}

TEST(InferChanges, OfRulesOfOtherShapesAreInferenceFromScratch) {
  for (unsigned seed = 10; seed < 14; ++seed) {
    ChangingStore store(seed, oddRules());
    expectFollowed(store);
  }
}

TEST(InferChanges, OfJoiningRulesAreInferenceFromScratch) {
  for (unsigned seed = 20; seed < 24; ++seed) {
    ChangingStore store(seed, joiningRules());
    expectFollowed(store);
    EXPECT_TRUE(store.sink.notes.empty()) << store.sink.notes.front();
  }
}

TEST(InferChanges, OfRulesThatDoNotBindTheirKeyInTimeAreInferenceFromScratch) {
  for (unsigned seed = 30; seed < 34; ++seed) {
    ChangingStore store(seed, unboundRules());
    expectFollowed(store);
  }
}

TEST(InferChanges, OfRulesThatBindTheirKeyFirstAreInferenceFromScratch) {
  for (unsigned seed = 40; seed < 42; ++seed) {
    ChangingStore store(seed, boundRules());
    expectFollowed(store);
  }
}

TEST(InferChanges, OfTypesThatStatementsRuleOutAreInferenceFromScratch) {
  std::size_t excluded = 0;
  for (unsigned seed = 70; seed < 76; ++seed) {
    ChangingStore store(seed, typingRules(), true);
    expectFollowed(store);
    excluded += store.excluded();
  }
  EXPECT_GT(excluded, 0U);
}

TEST(InferChanges, OfRulesThatAskOutsideOfTheirPatternsAreInferenceFromScratch) {
  for (const NamedText& rule : rulesThatAskOutside()) {
    ChangingStore store(60, {rule});
    for (int step = 0; step < stepsOf(20, 200) && !testing::Test::HasFatalFailure(); ++step) {
      SCOPED_TRACE(rule.name);
      store.step();
      store.expectInferenceFromScratch(step);
    }
  }
}

TEST(InferChanges, OfRulesOfAnyPropertyAreInferenceFromScratchAndEnd) {
  ChangingStore store(50, rulesOfAnyProperty());
  for (int step = 0; step < stepsOf(10, 100) && !testing::Test::HasFatalFailure(); ++step) {
    store.step();
    store.expectInferenceFromScratch(step);
  }
}

TEST(InferChanges, AStoreThatChangedWithoutInferenceIsInferredAnew) {
  ChangingStore store(2, shippedInputs().sparql_rules);
  {
    WriteTransaction transaction = store.environment().write();
    QuadWriter writer(transaction);
    writer.add(Quad{thing("tree", 0), Term::iri(vocabulary::clx("near")), thing("tree", 7),
                    Term::iri(vocabulary::kGraphOperator)});
    writer.flush();
    transaction.commit();
  }
  store.step();
  EXPECT_EQ(store.followed(), 0U);
  store.expectInferenceFromScratch(0);
  store.step();
  EXPECT_EQ(store.followed(), 1U);
}

TEST(RuleShapes, AreFollowedByKeyWhenTheyBindItFirst) {
  for (const auto& rules : {shippedInputs().sparql_rules, boundRules()})
    for (const NamedText& text : rules) {
      const RuleShape shape = shapeOf(text);
      EXPECT_EQ(shape.following, RuleShape::Following::ByKey) << text.name << ": " << shape.reason;
    }
  for (const NamedText& text : unboundRules()) {
    const RuleShape shape = shapeOf(text);
    EXPECT_EQ(shape.following, RuleShape::Following::AsWhole) << text.text;
    EXPECT_NE(shape.reason.find("where ?a is not bound yet"), std::string::npos) << shape.reason;
  }
}

}  // namespace
}  // namespace cluxel::mapping
