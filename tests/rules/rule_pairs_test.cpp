// SPDX-License-Identifier: Apache-2.0
// Pairs of rules that want the same thing: those that nothing tells apart, and those whose turn comes too late.
#include "rules/testing/rule_pairs.hpp"

#include <gmock/gmock.h>

#include "rules/reasoning_fixture.hpp"

namespace cluxel::testing {

namespace {

using ::testing::HasSubstr;

std::string bushAnd(const std::string& class_iri, const std::string& test, const std::string& evidence = "") {
  return "  - id: bush/low\n    class: clx:Bush\n    seed: { label: scatter }\n"
         "    tree: { test: top <= 2 m, yes: { accept: { confidence: 0.8 } }, no: { reject: high } }\n"
         "  - id: other/one\n    class: " +
         class_iri + "\n    seed: { label: scatter, as: body }\n" + evidence + "    tree: { test: " + test +
         ", yes: { accept: { confidence: 0.6 } }, no: { reject: other } }\n";
}

TEST(RulePairs, ShowsAThingThatTwoRivalsTakeWithoutEvidence) {
  const auto pairs = checkRulePairs(rulesOf("[[clx:Bush, clx:Vehicle]]", bushAnd("clx:Vehicle", "length >= 3 m")));
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].severity, Severity::Warning);
  EXPECT_THAT(pairs[0].message, HasSubstr("'bush/low' and 'other/one' can both take one thing"));
  EXPECT_THAT(pairs[0].message, HasSubstr("0.80 and 0.60"));
  EXPECT_THAT(pairs[0].hint, HasSubstr("label: scatter, box: { center: [0, 0, 1], size: ["));
}

TEST(RulePairs, KeepsSilentWhereTheTreesOrTheEvidenceDecide) {
  EXPECT_TRUE(checkRulePairs(rulesOf("[[clx:Bush, clx:Vehicle]]", bushAnd("clx:Vehicle", "top > 2 m"))).empty());
  EXPECT_TRUE(
      checkRulePairs(rulesOf("[[clx:Bush, clx:Vehicle]]",
                             bushAnd("clx:Vehicle", "length >= 3 m",
                                     "    evidence: [ { measure: width of whole, curve: { 1 m: 0, 2 m: 1 } } ]\n")))
          .empty());
}

TEST(RulePairs, ShowsARuleThatTakesOnlyWhatAnEarlierOneTakes) {
  const auto pairs = checkRulePairs(rulesOf("[clx:Bush, clx:Vehicle]", bushAnd("clx:Vehicle", "top <= 1 m")));
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_THAT(pairs[0].message, HasSubstr("'other/one' takes nothing that 'bush/low' does not take before it"));
  EXPECT_TRUE(checkRulePairs(rulesOf("[clx:Bush, clx:Vehicle]", bushAnd("clx:Vehicle", "top <= 3 m"))).empty());
}

}  // namespace

}  // namespace cluxel::testing
