// SPDX-License-Identifier: Apache-2.0
// Explanations of a map's own objects: every one can be told, and an `ask:` is answered as the build answered it.
#include "cluxel/tasks/explanation.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/reasoning/reason.hpp"
#include "mapping/asking_rules.hpp"
#include "tasks/campus_map_fixture.hpp"

namespace cluxel {
namespace {

using ::testing::HasSubstr;

TEST(Explanation, TellsOfObjectsByTheirRuleAndClass) {
  const MapReader& map = CampusMap::shared().map();
  std::map<std::string, int> told;
  for (const SemanticObject& object : map.objects()) {
    if (told[object.class_iri]++ > 0) continue;
    const std::string text = explainThing(map, object.id.hex(), false);
    EXPECT_THAT(text, HasSubstr(object.rule_id)) << object.class_iri;
    EXPECT_THAT(text, HasSubstr("clx:" + localName(object.class_iri)));
    EXPECT_THAT(text, HasSubstr("why:"));
    const auto json = nlohmann::json::parse(explainThing(map, object.id.hex(), true));
    EXPECT_TRUE(json.is_object());
  }
  EXPECT_GE(told.size(), 5U);
}

TEST(Explanation, TakesAPrimitiveByItsIri) {
  const MapReader& map = CampusMap::shared().map();
  const Primitive& primitive = map.scene().primitives.front();
  EXPECT_THAT(explainThing(map, iriOf(primitive), false), HasSubstr("primitive " + primitive.id.hex()));
}

TEST(Explanation, TakesNamesAsAnswersToQueriesWriteThem) {
  const MapReader& map = CampusMap::shared().map();
  const std::string hex = map.objects().front().id.hex();
  const std::string told = explainThing(map, hex, false);
  EXPECT_EQ(explainThing(map, "map:object/" + hex, false), told) << "as in a table";
  EXPECT_EQ(explainThing(map, "<https://w3id.org/cluxel/map/object/" + hex + ">", false), told)
      << "as in TSV and Turtle";
}

TEST(Explanation, RefusesNamesOfNothingAndOfTooMuch) {
  const MapReader& map = CampusMap::shared().map();
  EXPECT_THROW(explainThing(map, "abc", false), Error);
  EXPECT_THROW(explainThing(map, "zzzzzzzz", false), Error);
}

TEST(Explanation, AnswersAnAskAsTheBuildDid) {
  const ScratchFolder folder;
  const auto file = buildAskingMap(folder.path());
  const MapReader map(file);
  // The small object came after the bench; a question to the finished map would find it and turn the bench down.
  ASSERT_EQ(map.summary().objects_by_class.count("Bench"), 1U);
  ASSERT_EQ(map.summary().objects_by_class.count("SmallObject"), 1U);
  for (const SemanticObject& object : map.objects()) {
    const std::string text = explainThing(map, object.id.hex(), false);
    EXPECT_THAT(text, HasSubstr("belongs to clx:" + localName(object.class_iri) + " " + object.id.hex()));
  }
}

}  // namespace
}  // namespace cluxel
