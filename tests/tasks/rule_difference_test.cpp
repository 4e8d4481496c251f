// SPDX-License-Identifier: Apache-2.0
// Trying rules on a map: its own rules change nothing, and every change is told once.
#include "tasks/rule_trial/rule_difference.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cluxel/error.hpp"
#include "rules/decide/reason.hpp"
#include "tasks/campus_map_fixture.hpp"

namespace cluxel::tasks {

using namespace mapping;
namespace {

using ::testing::HasSubstr;

RuleSet ownRules() {
  return rulesForMap(CampusMap::shared().map(), "mine.yaml",
                     "apiVersion: cluxel.rules/v1\ninclude: [ outdoor.rules.yaml ]\n");
}

RuleSet changedRules(const std::string& override_text) {
  return rulesForMap(CampusMap::shared().map(), "mine.yaml",
                     "apiVersion: cluxel.rules/v1\ninclude: [ outdoor.rules.yaml ]\noverride:\n" + override_text);
}

/// Rules that others name in hints cannot be removed: they reject everything instead.
std::string withoutRules(const std::vector<std::string>& ids) {
  std::string text = "  rules:\n";
  for (const std::string& id : ids) text += "    - { id: " + id + ", tree: { reject: off } }\n";
  return text;
}

TEST(RuleDifference, OfAMapsOwnRulesIsEmpty) {
  const MapReader& map = CampusMap::shared().map();
  const RuleDifference difference = trialOf(map, ownRules());
  EXPECT_TRUE(difference.isEmpty()) << textOf(difference);
  EXPECT_EQ(difference.before, map.objects().size());
  EXPECT_THAT(textOf(difference), HasSubstr("no difference"));
}

TEST(RuleDifference, AccountsForEveryObjectOnBothSides) {
  const MapReader& map = CampusMap::shared().map();
  const RuleSet changed = changedRules(withoutRules({"vehicle/car", "tree/trunk-and-top"}));
  const RuleDifference difference = trialOf(map, changed);
  const auto result = reason(map.scene(), changed, {});
  std::set<std::string> before, after, known_before, known_after;
  for (const SemanticObject& object : map.objects()) known_before.insert(object.id.hex());
  for (const SemanticObject& object : result.objects) known_after.insert(object.id.hex());
  std::size_t changes = 0;
  for (const ObjectChange& change : difference.changes) {
    if (change.before) {
      EXPECT_TRUE(before.insert(change.before->id.hex()).second);
    }
    if (change.after) {
      EXPECT_TRUE(after.insert(change.after->id.hex()).second);
    }
    const bool other_class = !change.before || !change.after || change.before->class_name != change.after->class_name;
    changes += other_class ? 1 : 0;
    EXPECT_GT(change.points, 0);
  }
  EXPECT_GT(changes, 0U);
  for (const std::string& id : known_before)
    if (!before.contains(id)) {
      EXPECT_TRUE(known_after.contains(id)) << id;
    }
  for (const std::string& id : known_after)
    if (!after.contains(id)) {
      EXPECT_TRUE(known_before.contains(id)) << id;
    }
  std::size_t counted = 0;
  for (const auto& [classes, count] : difference.class_changes) counted += count;
  EXPECT_EQ(counted, changes);
}

TEST(RuleDifference, IsTheSameBackwards) {
  const MapReader& map = CampusMap::shared().map();
  const RuleSet changed = changedRules(withoutRules({"bush/low-scatter"}));
  const RuleDifference there = differenceOf(map, ownRules(), changed), back = differenceOf(map, changed, ownRules());
  ASSERT_EQ(there.changes.size(), back.changes.size());
  EXPECT_FALSE(there.isEmpty());
  for (const auto& [classes, count] : there.class_changes)
    EXPECT_EQ(back.class_changes.at({classes.second, classes.first}), count) << classes.first;
}

TEST(RuleDifference, OfAConfidenceNamesTheObjectAndKeepsItsClass) {
  const RuleDifference difference = trialOf(CampusMap::shared().map(), changedRules(R"(  rules:
    - id: ground/patches
      tree:
        test: footprint_area >= 4 m2
        yes: { accept: { merge_into: class, confidence: 0.5 } }
        no: { accept: { merge_into: class, confidence: 0.5 } }
)"));
  ASSERT_FALSE(difference.isEmpty());
  for (const ObjectChange& change : difference.changes) {
    EXPECT_EQ(change.kind, ObjectChangeKind::Confidence);
    EXPECT_EQ(change.after->class_name, "Ground");
    EXPECT_EQ(change.after->confidence, 0.5);
  }
  const auto json = nlohmann::json::parse(jsonOf(difference));
  EXPECT_EQ(json.at("counts").at("confidence"), difference.changes.size());
  EXPECT_EQ(json.at("changes").at(0).at("before").at("class"), "Ground");
}

TEST(RuleDifference, ColoursEveryPointOfTheMap) {
  const MapReader& map = CampusMap::shared().map();
  std::string ply, plain;
  writeDifferencePly(map, trialOf(map, changedRules(withoutRules({"vehicle/car"}))),
                     [&](std::string_view piece) { ply.append(piece); });
  exportMap(map, ExportFormat::Ply, [&](std::string_view piece) { plain.append(piece); });
  EXPECT_EQ(ply.size(), plain.size());
  EXPECT_NE(ply, plain);
}

TEST(RuleDifference, OfFaultyRulesTellsTheLineWithoutFoldersOfTheMachine) {
  try {
    changedRules("  remove: [ vehicle/cart ]\n");
    FAIL();
  } catch (const InputError& fault) {
    EXPECT_EQ(fault.diagnostics().front().location.file, "mine.yaml");
    EXPECT_THAT(fault.diagnostics().front().hint, HasSubstr("vehicle/car"));
  }
}

}  // namespace
}  // namespace cluxel::tasks
