// SPDX-License-Identifier: Apache-2.0
// Fitting evidence: known log-odds are found again, little data changes nothing, and the text keeps its form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "cluxel/error.hpp"
#include "rules/language/rule_loader.hpp"
#include "rules/propose/evidence.hpp"
#include "tasks/rule_fitting/evidence_fit.hpp"
#include "tasks/rule_fitting/round_number.hpp"
#include "tasks/rule_fitting/rule_text_edit.hpp"

namespace cluxel::testing {

using namespace tasks;
namespace {

const std::string kText = R"(apiVersion: cluxel.rules/v1
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Tree]
rules:
  - id: tree/any
    class: clx:Tree
    seed: { label: column }
    evidence:                              # what speaks for it
      - { attribute: height, curve: { 1 m: 0, 3 m: 0 } }     # high ones
      - { when: { attribute: roughness, op: ">=", value: 5 cm }, weight: 0 }
    tree:
      test: { attribute: height, op: ">=", value: 1 m }
      yes: { accept: { confidence: 0.5 } }
      no: { reject: low }
)";

rules::RuleSet ruleSet() {
  rules::ClassCatalogue catalogue;
  catalogue.classes.push_back({"https://w3id.org/cluxel/ontology#Tree", {}, {}});
  return loadRuleTexts(std::vector{rules::RuleSource{"tree.yaml", kText}}, 1, catalogue, {}).require();
}

/// Candidates of twenty places, right with the log-odds 1 + 3 * (is high) - 2 * (is rough).
std::vector<CandidateExample> examples(int count) {
  std::mt19937 random(5);
  std::vector<CandidateExample> made;
  for (int i = 0; i < count; ++i) {
    CandidateExample example;
    example.rule_id = "tree/any";
    example.class_iri = "https://w3id.org/cluxel/ontology#Tree";
    example.leaf = 1;
    example.is_named = true;
    example.place = "place " + std::to_string(i % 20);
    const bool is_high = random() % 2 == 0, is_rough = random() % 2 == 0;
    example.values = {is_high ? 3.0 : 1.0, is_rough ? 1.0 : 0.0};
    const double chance = rules::probabilityOf(-1.0 + (is_high ? 3 : 0) - (is_rough ? 2 : 0));
    example.is_right = static_cast<double>(random() % 10000) < chance * 10000;
    made.push_back(std::move(example));
  }
  return made;
}

TEST(RuleFitting, FindsTheLogOddsThatMadeTheData) {
  const auto fitted = fitEvidence(ruleSet(), examples(4000), {.ridge = 0.1});
  ASSERT_EQ(fitted.size(), 1U);
  EXPECT_TRUE(fitted[0].refusal.empty());
  EXPECT_LT(fitted[0].loss_after, fitted[0].loss_before);
  double low = 0, high = 0, rough = 0;
  for (const FittedNumber& change : fitted[0].changes) {
    if (change.what.ends_with(" at 1")) low = change.after;
    if (change.what.ends_with(" at 3")) high = change.after;
    if (change.what.starts_with("roughness")) rough = change.after;
  }
  EXPECT_NEAR(high - low, 3, 0.6);
  EXPECT_NEAR(rough, -2, 0.5);
}

TEST(RuleFitting, ChangesNothingWhereFewerThanTenSpeak) {
  const auto fitted = fitEvidence(ruleSet(), examples(8), {});
  ASSERT_EQ(fitted.size(), 1U);
  EXPECT_THAT(fitted[0].refusal, ::testing::HasSubstr("fewer than 10"));
  EXPECT_TRUE(fitted[0].changes.empty());
}

TEST(RuleFitting, IsNotSureOfAFewThatWereAllRight) {
  std::vector<CandidateExample> all_right = examples(27);
  for (CandidateExample& example : all_right) example.is_right = true;
  const auto fitted = fitEvidence(ruleSet(), all_right, {});
  ASSERT_EQ(fitted.size(), 1U);
  ASSERT_EQ(fitted[0].changes.size(), 1U);
  EXPECT_TRUE(fitted[0].changes[0].is_share);
  EXPECT_NEAR(fitted[0].changes[0].after, 28.0 / 29.0, 0.02);
}

TEST(RuleFitting, KeepsNumbersThatAreBetterOnPlacesLeftOut) {
  rules::RuleSet sure = ruleSet();
  std::get<rules::AcceptLeaf>(sure.rules[0].nodes[1].what).confidence.high = 0.999;
  std::vector<CandidateExample> all_right = examples(27);
  for (CandidateExample& example : all_right) {
    example.is_right = true;
    example.confidence = rules::logOdds(0.999);
  }
  const auto fitted = fitEvidence(sure, all_right, {});
  ASSERT_EQ(fitted.size(), 1U);
  EXPECT_GT(fitted[0].loss_after, fitted[0].loss_before);
  EXPECT_THAT(fitted[0].refusal, ::testing::HasSubstr("worse on places left out: log loss 0.001 -> "));
  EXPECT_FALSE(fitted[0].is_fitted);
  EXPECT_TRUE(fitted[0].changes.empty());
}

TEST(RuleFitting, ChangesNothingWhereNoPlaceCanBeLeftOut) {
  std::vector<CandidateExample> one_scan = examples(400);
  for (CandidateExample& example : one_scan) example.place = "the only scan";
  const auto fitted = fitEvidence(ruleSet(), one_scan, {});
  ASSERT_EQ(fitted.size(), 1U);
  EXPECT_THAT(fitted[0].refusal, ::testing::HasSubstr("of one scan"));
  EXPECT_TRUE(fitted[0].changes.empty());
}

TEST(RuleFitting, GivesTheSameNumbersTwice) {
  const auto a = fitEvidence(ruleSet(), examples(300), {}), b = fitEvidence(ruleSet(), examples(300), {});
  ASSERT_EQ(a[0].changes.size(), b[0].changes.size());
  for (std::size_t i = 0; i < a[0].changes.size(); ++i) EXPECT_EQ(a[0].changes[i].after, b[0].changes[i].after);
}

TEST(RuleFitting, IgnoresTruthsThatDoNotNameAClassOthersName) {
  auto all = examples(400);
  auto more = all;
  for (CandidateExample& example : more) {
    example.is_named = false;
    example.is_right = !example.is_right;
    all.push_back(example);
  }
  const auto with = fitEvidence(ruleSet(), all, {}), without = fitEvidence(ruleSet(), examples(400), {});
  EXPECT_EQ(with[0].right, without[0].right);
  EXPECT_EQ(with[0].wrong, without[0].wrong);
}

TEST(RuleFitting, WritesNumbersAndKeepsTheRestOfTheText) {
  const auto fitted = fitEvidence(ruleSet(), examples(4000), {});
  const std::string changed = withNumbers(kText, "tree.yaml", fitted[0].changes);
  EXPECT_NE(changed, kText);
  EXPECT_THAT(changed, ::testing::HasSubstr("# what speaks for it\n"));
  EXPECT_THAT(changed, ::testing::HasSubstr("}     # high ones\n"));
  const auto blank = [](std::string text) {
    std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; });
    return text;
  };
  EXPECT_EQ(blank(changed), blank(kText));
  rules::ClassCatalogue catalogue;
  catalogue.classes.push_back({"https://w3id.org/cluxel/ontology#Tree", {}, {}});
  const auto again = loadRuleTexts(std::vector{rules::RuleSource{"tree.yaml", changed}}, 1, catalogue, {}).require();
  EXPECT_LT(again.rules[0].evidence[1].weight, -1);
}

/// The rule of kText with its evidence as a definition, used by a second rule or not.
rules::RuleSet ruleSetWithDefinition(bool used_twice) {
  std::string text = kText;
  const std::string list =
      "\n      - { attribute: height, curve: { 1 m: 0, 3 m: 0 } }     # high ones\n      - { when: { "
      "attribute: roughness, op: \">=\", value: 5 cm }, weight: 0 }\n";
  const std::size_t at = text.find("                              # what speaks for it" + list);
  text.replace(at, ("                              # what speaks for it" + list).size(), " { use: looks }\n");
  text.insert(text.find("rules:\n"), "define:\n    looks:" + list);
  std::string second = text.substr(text.find("  - id: tree/any"));
  second.replace(second.find("tree/any"), 8, "tree/two");
  rules::ClassCatalogue catalogue;
  catalogue.classes.push_back({"https://w3id.org/cluxel/ontology#Tree", {}, {}});
  return loadRuleTexts(std::vector{rules::RuleSource{"tree.yaml", used_twice ? text + second : text}}, 1, catalogue, {})
      .require();
}

TEST(RuleFitting, FitsANumberOfADefinitionAsIfItWereWrittenOut) {
  const auto plain = fitEvidence(ruleSet(), examples(2000), {}),
             defined = fitEvidence(ruleSetWithDefinition(false), examples(2000), {});
  ASSERT_EQ(plain[0].changes.size(), defined[0].changes.size());
  for (std::size_t i = 0; i < plain[0].changes.size(); ++i)
    EXPECT_EQ(plain[0].changes[i].after, defined[0].changes[i].after);
  EXPECT_EQ(defined[0].kept, 0U);
}

TEST(RuleFitting, KeepsTheNumbersOfADefinitionThatAnotherRuleUses) {
  const auto fitted = fitEvidence(ruleSetWithDefinition(true), examples(2000), {});
  EXPECT_EQ(fitted[0].kept, 3U);
  ASSERT_EQ(fitted[0].changes.size(), 1U) << "its own confidence";
  EXPECT_EQ(fitted[0].changes[0].what, "confidence");
}

TEST(RuleFitting, RefusesATextThatIsNotTheOneThatWasRead) {
  FittedNumber number;
  number.at = {.file = "a", .line = 1, .column = 1};
  EXPECT_THROW(withNumbers("text", "a", {number}), Error);
  number.at.line = 7;
  EXPECT_THROW(withNumbers("1", "a", {number}), Error);
}

TEST(RoundNumber, HasTheFewestDigitsInTheInterval) {
  EXPECT_DOUBLE_EQ(roundestIn(1.7, 2.6), 2);
  EXPECT_DOUBLE_EQ(roundestIn(-0.3, 0.4), 0);
  EXPECT_DOUBLE_EQ(roundestIn(1.41, 1.58), 1.5);
  EXPECT_NEAR(roundestIn(1.231, 1.239), 1.235, 1e-9);
}

}  // namespace
}  // namespace cluxel::testing
