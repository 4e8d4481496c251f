// SPDX-License-Identifier: Apache-2.0
// Every fault of a rule file is found, at its place, with the remedy. One row per kind of fault.
#include <gmock/gmock.h>

#include <algorithm>

#include "rules/reasoning_fixture.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// A file without faults; each test replaces one fragment of its text.
const std::string kGood = R"(apiVersion: cluxel.rules/v1
ruleset: { name: small, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
constants:
  ground_gap: 0.30 m
order: [clx:Ground, clx:Tree]
rules:
  - id: ground/main
    class: clx:Ground
    seed: { label: horizontal_plane }
    tree:
      test: { attribute: footprint_area, op: ">=", value: 20 m2 }
      yes: { accept: { confidence: 0.98 } }
      no: { reject: too small }
  - id: tree/trunk
    class: clx:Tree
    seed: { label: column, as: trunk }
    tree:
      test: { relation: touches_ground, within: $ground_gap }
      yes:
        find: { as: top, label: scatter, relations: [ { above: trunk } ], choose: all }
        found: { accept: { parts: { trunk: clx:TreeTrunk, top: clx:TreeTop }, confidence: 0.9 } }
        missing: { reject: no crown, hint: ground/main }
      no: { reject: in the air }
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

struct FaultCase {
  friend void PrintTo(const FaultCase& fault, std::ostream* out) { *out << fault.name; }
  std::string name;
  std::string what, by;  ///< what of the good file is replaced
  std::size_t line, column;
  std::string message;  ///< part of the message
  std::string hint;     ///< part of the hint
};

TEST(RuleFaults, AreNotCrowdedOutByWarningsAndCountedWhereThereAreTooMany) {
  std::string constants;
  for (int i = 0; i < 300; ++i) constants += "  unused_" + std::to_string(i) + ": 1 m\n";
  const LoadedRules warned = loadText(replaced(kGood, "  ground_gap: 0.30 m\n", "  ground_gap: 0.30 m\n" + constants));
  EXPECT_TRUE(warned.rules.has_value());
  ASSERT_EQ(warned.diagnostics.size(), 201U);
  EXPECT_EQ(warned.diagnostics.back().message, "100 further warnings");
  EXPECT_FALSE(hasErrors(warned.diagnostics));
  std::string wrong;
  for (int i = 0; i < 250; ++i) wrong += "  wrong_" + std::to_string(i) + ": 1 furlong\n";
  const LoadedRules refused =
      loadText(replaced(kGood, "  ground_gap: 0.30 m\n", "  ground_gap: 0.30 m\n" + constants + wrong));
  EXPECT_FALSE(refused.rules.has_value());
  EXPECT_TRUE(hasErrors(refused.diagnostics));
  const auto errors = std::count_if(refused.diagnostics.begin(), refused.diagnostics.end(),
                                    [](const Diagnostic& fault) { return fault.severity == Severity::Error; });
  EXPECT_EQ(errors, 201) << "200 and the word about the others";
}

class RuleFault : public ::testing::TestWithParam<FaultCase> {};

TEST_P(RuleFault, IsReportedAtItsPlaceWithTheRemedy) {
  const FaultCase& fault = GetParam();
  const LoadedRules loaded = loadText(replaced(kGood, fault.what, fault.by));
  EXPECT_FALSE(loaded.rules.has_value());
  ASSERT_EQ(loaded.diagnostics.size(), 1U) << format(loaded.diagnostics);
  const Diagnostic& found = loaded.diagnostics.front();
  EXPECT_EQ(found.location.file, "rules.yaml");
  EXPECT_EQ(std::pair(found.location.line, found.location.column), std::pair(fault.line, fault.column))
      << format(found);
  EXPECT_THAT(found.message, ::testing::HasSubstr(fault.message));
  EXPECT_THAT(found.hint, ::testing::HasSubstr(fault.hint));
  EXPECT_FALSE(found.source_line.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, RuleFault,
    ::testing::Values(
        FaultCase{"UnknownKeyOfTheFile", "ruleset:", "rulesset:", 2, 1, "unknown key 'rulesset'", "'ruleset'"},
        FaultCase{"UnknownKeyOfARule", "    class: clx:Ground\n", "    class: clx:Ground\n    sed: x\n", 10, 5,
                  "unknown key 'sed' in 'rule'", "'seed'"},
        FaultCase{"UnknownKeyOfACondition", "value: 20 m2", "valu: 20 m2", 12, 52, "unknown key 'valu'", "'value'"},
        FaultCase{"ShareOfALabelWithoutAnOperator", "attribute: footprint_area, op: \">=\", value: 20 m2",
                  "label: horizontal_plane, value: 0.5", 12, 13, "needs the key 'op'", ""},
        FaultCase{"OtherVersion", "rules/v1", "rules/v7", 1, 13, "version 'cluxel.rules/v7'", "cluxel.rules/v1"},
        FaultCase{"RepeatedKey", "      no: { reject: too small }\n",
                  "      no: { reject: too small }\n      no: { reject: a roof }\n", 15, 7, "'no' stands here twice",
                  "line 14"},
        FaultCase{"EvidenceThatMeasuresNothing", "    class: clx:Ground\n",
                  "    class: clx:Ground\n    evidence:\n      - { curve: { 1 m: 0, 2 m: 1 } }\n", 11, 9,
                  "measures one thing", "attribute"},
        FaultCase{"EvidenceOfTwoKinds", "    class: clx:Ground\n",
                  "    class: clx:Ground\n    evidence:\n      - { attribute: height, about: 1 m, curve: { 1 m: 0, 2 "
                  "m: 1 } }\n",
                  11, 9, "one of 'curve', 'about' and 'when'", ""},
        FaultCase{"CurveThatDoesNotGrow", "    class: clx:Ground\n",
                  "    class: clx:Ground\n    evidence:\n      - { attribute: height, curve: { 2 m: 0, 1 m: 1 } }\n",
                  11, 47, "must grow", ""},
        FaultCase{"CurveInAnotherUnit", "    class: clx:Ground\n",
                  "    class: clx:Ground\n    evidence:\n      - { attribute: height, curve: { 1: 0, 2 m: 1 } }\n", 11,
                  39, "a length is expected", "1 m"},
        FaultCase{"ClassInTwoStrata", "order: [clx:Ground, clx:Tree]", "order: [clx:Ground, [clx:Tree, clx:Ground]]", 6,
                  32, "stands in the order twice", ""},
        FaultCase{"LeaveWithoutReject", "no: { reject: too small }", "no: { leave: unknown }", 14, 11,
                  "a node that does nothing", "{ reject: reason, leave: unknown }"},
        FaultCase{"LeaveInAnotherNode", "yes: { accept: { confidence: 0.98 } }",
                  "yes: { accept: { confidence: 0.98 }, leave: unknown }", 13, 44,
                  "'leave' has no meaning in this node", "beside 'reject'"},
        FaultCase{"ReservedName", "label: horizontal_plane }", "label: horizontal_plane, as: whole }", 10, 42,
                  "all parts of a candidate", "another name"},
        FaultCase{"UnknownClass", "class: clx:Tree\n", "class: clx:Tre\n", 16, 12, "no class 'clx:Tre'", "clx:Tree"},
        FaultCase{"NoPrefix", "class: clx:Tree\n", "class: tree\n", 16, 12, "'tree' is not a class name",
                  "its prefix: 'clx:Tree'"},
        FaultCase{"NoPrefixAndNoSuchClass", "class: clx:Tree\n", "class: Pumpkins\n", 16, 12,
                  "'Pumpkins' is not a class name", "such as 'clx:Tree'"},
        FaultCase{"UnknownPrefix", "class: clx:Tree\n", "class: cl:Tree\n", 16, 12, "unknown prefix 'cl:'", "clx"},
        FaultCase{"PartOfAnotherClass", "top: clx:TreeTop", "top: clx:LampHead", 22, 64, "no part 'clx:LampHead'",
                  "clx:TreeTop"},
        FaultCase{"UnknownAttribute", "footprint_area", "footprint_aera", 12, 26, "unknown attribute 'footprint_aera'",
                  "footprint_area"},
        FaultCase{"UnknownRelation", "relation: touches_ground", "relation: touch_ground", 19, 25,
                  "unknown relation 'touch_ground'", "touches_ground"},
        FaultCase{"UnknownLabel", "label: scatter", "label: scater", 21, 33, "unknown label 'scater'", "scatter"},
        FaultCase{"UnknownOperator", "\">=\"", "\"=>\"", 12, 46, "unknown operator '=>'", "<="},
        FaultCase{"UnknownChoice", "choose: all", "choose: al", 21, 83, "unknown choice 'al'", "'all'"},
        FaultCase{"FartherThanIsMeasured", "relations: [ { above: trunk } ]",
                  "where: [ { gap_to: trunk, op: \"<=\", value: 60 m } ]", 21, 85,
                  "nothing farther than 49.5 m is measured", "neighbours"},
        FaultCase{"AShareOfACount", "attribute: footprint_area, op: \">=\", value: 20 m2",
                  "attribute: point_count, op: \">=\", value: 50 %", 12, 56,
                  "is a share where a number of things is expected", ""},
        FaultCase{"UnknownUnit", "20 m2", "20 sqm", 12, 59, "unknown unit 'sqm'", "m2"},
        FaultCase{"BareNumber", "20 m2", "20", 12, 59, "a bare number where an area", "20 m2"},
        FaultCase{"WrongDimension", "20 m2", "20 m", 12, 59, "'20 m' is a length where an area", ""},
        FaultCase{"ConstantOfAnotherDimension", "20 m2", "$ground_gap", 12, 59, "is a length where an area", ""},
        FaultCase{"UnknownConstant", "within: $ground_gap", "within: $ground_gab", 19, 49, "unknown constant", ""},
        FaultCase{"NotAQuantity", "0.30 m", "wide", 5, 15, "'wide' is not a quantity", "2.5 m"},
        FaultCase{"UnboundName", "{ above: trunk }", "{ above: trunc }", 21, 64, "nothing is bound to 'trunc'",
                  "trunk"},
        FaultCase{"NameUsedWhereItIsMissing", "missing: { reject: no crown, hint: ground/main }",
                  "missing: { accept: { parts: { top: clx:TreeTop }, confidence: 0.5 } }", 23, 39,
                  "nothing is bound to 'top'", ""},
        FaultCase{
            "NameBoundTwice", "missing: { reject: no crown, hint: ground/main }",
            "missing: { find: { as: trunk, label: column, relations: [ { near: trunk } ] }, found: { reject: a }, "
            "missing: { reject: b } }",
            23, 32, "already bound", ""},
        FaultCase{"UnknownHint", "hint: ground/main", "hint: ground/mian", 23, 18, "no rule: 'ground/mian'",
                  "ground/main"},
        FaultCase{"RuleIdTwice", "id: tree/trunk", "id: ground/main", 15, 9, "already used", ""},
        FaultCase{"ConfidenceAboveOne", "confidence: 0.98", "confidence: 98", 13, 36, "between 0 and 1", ""},
        FaultCase{"MissingBranch", "      no: { reject: in the air }\n", "", 19, 7, "needs the key 'no'", ""},
        FaultCase{"ClassOutsideTheOrder", "order: [clx:Ground, clx:Tree]", "order: [clx:Ground]", 15, 5,
                  "does not stand in 'order'", ""},
        FaultCase{"FindWithoutAPlace", "relations: [ { above: trunk } ], ", "", 21, 15, "does not say where to look",
                  ""},
        FaultCase{"LaterClassLookedAt", "test: { relation: touches_ground, within: $ground_gap }",
                  "test: { relation: near, within: $ground_gap, with: { object: clx:StreetLamp } }", 19, 13,
                  "no clx:StreetLamp exists yet", "earlier"},
        FaultCase{"TwoNodesInOne", "yes: { accept: { confidence: 0.98 } }",
                  "yes: { accept: { confidence: 0.98 }, reject: no }", 13, 44, "'accept' and 'reject' in one node", ""},
        FaultCase{"SliceUpsideDown", "{ attribute: footprint_area",
                  "{ slice: { from: 2 m, to: 1 m }, attribute: footprint_area", 12, 22, "'to' is not above 'from'", ""},
        FaultCase{"SliceWithoutAnEnd", "{ attribute: footprint_area",
                  "{ slice: { from: 2 m }, attribute: footprint_area", 12, 22, "'slice' needs the key 'to'", ""},
        FaultCase{"SliceOfAnotherDimension", "{ attribute: footprint_area",
                  "{ slice: { from: 0 m, to: 1 m2 }, attribute: footprint_area", 12, 39,
                  "'1 m2' is an area where a length", ""},
        FaultCase{"SliceOfARelation", "within: $ground_gap", "within: $ground_gap, slice: { from: 0 m, to: 1 m }", 19,
                  62, "'slice' has no meaning in this condition", ""},
        FaultCase{"SliceOfWhatOnlyPrimitivesKnow", "attribute: footprint_area, op: \">=\", value: 20 m2",
                  "slice: { from: 0 m, to: 1 m }, attribute: view_count, op: \">=\", value: 2", 12, 57,
                  "'view_count' is known of whole primitives only", "leave 'slice' out"},
        FaultCase{"TwoTestsInOne", "footprint_area, op", "footprint_area, label: column, op", 12, 42,
                  "'attribute' and 'label' in one condition", "all"},
        FaultCase{"Anchor", "value: 20 m2", "value: &area 20 m2", 12, 59, "anchors and aliases are not supported",
                  "write the value out"},
        FaultCase{"UnreachableBranch", "yes: { accept: { confidence: 0.98 } }",
                  "yes: { test: { attribute: footprint_area, op: \"<\", value: 10 m2 }, yes: { reject: a }, no: { "
                  "reject: b } }",
                  13, 79, "nothing can get here", "line 13"},
        FaultCase{"AlwaysPassingTest", "value: 20 m2", "value: -1 m2", 14, 11, "nothing can get here", "line 12"},
        FaultCase{"ShareOfALabelAboveOne", "{ attribute: footprint_area, op: \">=\", value: 20 m2 }",
                  "horizontal_plane share >= 1.5", 13, 12, "a share lies between 0 and 1", "line 12"},
        FaultCase{"ShareOfALabelBelowZero", "{ attribute: footprint_area, op: \">=\", value: 20 m2 }",
                  "horizontal_plane share >= 0", 14, 11, "a share lies between 0 and 1", "line 12"},
        FaultCase{"MergeWithoutARelation", "confidence: 0.98", "merge_into: related, confidence: 0.98", 13, 12,
                  "no relation to an object", ""},
        FaultCase{"MergeIntoSomethingElse", "confidence: 0.98", "merge_into: nearest, confidence: 0.98", 13, 36,
                  "'merge_into' takes 'related' or 'class'", ""},
        FaultCase{"AbsorbWithoutEvidence", "confidence: 0.9 }",
                  "confidence: 0.9, absorb: { from: { label: scatter }, into: trunk, when: [ { gap_to: top, op: \">\", "
                  "value: 1 m } ] } }",
                  22, 151, "needs evidence", ""},
        FaultCase{"GatherWithoutAHeight", "confidence: 0.9 }",
                  "confidence: 0.9, split: { shared: top, from: trunk, gather: { within: 1 m } } }", 22, 139,
                  "needs the key 'above'", ""},
        FaultCase{"GatherInTheWrongUnit", "confidence: 0.9 }",
                  "confidence: 0.9, split: { shared: top, from: trunk, gather: { within: 1 m2, above: 1 m } } }", 22,
                  149, "m2", ""}),
    [](const auto& info) { return info.param.name; });

TEST(RuleFaults, AreAbsentFromAGoodFile) {
  const LoadedRules loaded = loadText(kGood);
  EXPECT_TRUE(loaded.diagnostics.empty()) << format(loaded.diagnostics);
  ASSERT_TRUE(loaded.rules.has_value());
  EXPECT_EQ(loaded.rules->rules.size(), 2U);
  EXPECT_EQ(loaded.rules->order.front(), clx("Ground"));
}

TEST(RuleFaults, AreAllReportedAtOnce) {
  std::string text = replaced(kGood, "footprint_area", "footprint_aera");
  text = replaced(text, "label: scatter", "label: scater");
  text = replaced(text, "hint: ground/main", "hint: ground/mian");
  text = replaced(text, "0.98", "98");
  EXPECT_EQ(loadText(text).diagnostics.size(), 4U) << format(loadText(text).diagnostics);
}

TEST(RuleFaults, ShowTheLineWithACaret) {
  const LoadedRules loaded = loadText(replaced(kGood, "label: scatter", "label: scater"));
  EXPECT_EQ(format(loaded.diagnostics.front()),
            "rules.yaml:21:33: error: unknown label 'scater'\n"
            "          find: { as: top, label: scater, relations: [ { above: trunk } ], choose: all }\n"
            "                                  ^\n"
            "  hint: did you mean 'scatter'?");
}

TEST(RuleFaults, OfFormAreReportedWithTheirLine) {
  const LoadedRules loaded = loadText("apiVersion: cluxel.rules/v1\nrules: [ {\n");
  ASSERT_FALSE(loaded.diagnostics.empty());
  EXPECT_GE(loaded.diagnostics.front().location.line, 2U);
}

TEST(RuleFaults, WarnOfConstantsThatNothingUses) {
  const LoadedRules loaded = loadText(replaced(kGood, "within: $ground_gap", "within: 0.3 m"));
  ASSERT_EQ(loaded.diagnostics.size(), 1U);
  EXPECT_EQ(loaded.diagnostics.front().severity, Severity::Warning);
  EXPECT_TRUE(loaded.rules.has_value());
}

}  // namespace
}  // namespace cluxel::testing
