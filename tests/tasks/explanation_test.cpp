// SPDX-License-Identifier: Apache-2.0
// Explanations of a map's own objects: each has one, and an `ask:` is answered as the build answered it.
#include "tasks/explanation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "cluxel/error.hpp"
#include "mapping/asking_rules.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/long_tests.hpp"
#include "mapping/map_part.hpp"
#include "rdf/map_iris.hpp"
#include "rules/decide/local_reach.hpp"
#include "rules/decide/reason.hpp"
#include "rules/explain/part_run.hpp"
#include "rules/explain/why_not.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/explanation_names.hpp"
#include "tasks/named_class.hpp"
#include "tasks/object_explanations.hpp"
#include "test_paths.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
using namespace mapping;
namespace {

using ::testing::HasSubstr;

TEST(Explanation, NamesRuleAndClassOfObjects) {
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

TEST(Explanation, FromAPartOfTheMapIsThatOfTheWhole) {
  const MapReader& map = CampusMap::shared().map();
  const MapInputs inputs = map.inputs();
  std::vector<RuleSource> sources;
  for (const NamedText& text : inputs.rules) sources.push_back({text.name, text.text});
  const RuleSet rules = loadRuleTexts(sources, inputs.rule_roots, classCatalogueOf(inputs.ontology)).require();
  const std::vector<std::uint64_t> traces = map.decisionTraces();
  ASSERT_EQ(traces.size(), map.scene().primitives.size());
  std::size_t in_part = 0;
  for (std::size_t i = 0; i < map.objects().size(); i += 4) {
    const SemanticObject& object = map.objects()[i];
    const auto run = runInPart(map.scene(), rules, {traces, map.objects()}, primitivesOf(object));
    if (!run) continue;
    ++in_part;
    const auto near = explanationIn(run->result, rules, object.id);
    const auto whole = explain(map.scene(), rules, {}, object);
    ASSERT_TRUE(near && whole);
    EXPECT_EQ(textOf(*near, rules, *run->part), textOf(*whole, rules, map.scene())) << "object " << i;
  }
  EXPECT_GE(in_part, 5U);
}

/// The text without the folder of the rules, which explainThing() leaves out.
std::string withoutFolder(std::string text, const MapInputs& inputs) {
  const std::string folder = std::filesystem::path(inputs.rules.front().name).parent_path().string() + "/";
  for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder, at))
    text.erase(at, folder.size());
  return text;
}

/// A map of more tiles than an explanation reads.
class ExplanationOfALongMap : public ::testing::Test {
 protected:
  void build(const CampusParams& params = {
                 .seed = 5, .stops = 12, .size_m = 150, .points_per_stop = 7000, .max_range_m = 16}) {
    const SmallCampus campus(params);
    buildMap(scansOf(campus.files()), shippedInputs(), folder.path() / "street.clx", {.threads = 2}, silence());
    map.emplace(folder.path() / "street.clx");
    inputs = map->inputs();
    std::vector<RuleSource> sources;
    for (const NamedText& text : inputs.rules) sources.push_back({text.name, text.text});
    rules = loadRuleTexts(sources, inputs.rule_roots, classCatalogueOf(inputs.ontology)).require();
  }

  ScratchFolder folder;
  std::optional<MapReader> map;
  MapInputs inputs;
  RuleSet rules;
};

TEST_F(ExplanationOfALongMap, OfAnObjectThroughoutTheMapReadsSomeTilesToo) {
  build();
  const auto& objects = map->objects();
  const auto ground =
      std::find_if(objects.begin(), objects.end(), [](const SemanticObject& object) { return object.is_class_wide; });
  ASSERT_NE(ground, objects.end());
  const auto sample = map->samplePrimitiveOf(ground->id);
  ASSERT_TRUE(sample && map->partAroundTile(sample->tile, {}));
  const auto& primitives = map->scene().primitives;
  const auto at = std::find_if(primitives.begin(), primitives.end(),
                               [&](const Primitive& primitive) { return primitive.id == sample->primitive; });
  ASSERT_NE(at, primitives.end());
  const Explanation whole = explain(map->scene(), rules, {}, static_cast<PrimitiveIndex>(at - primitives.begin()));
  ASSERT_TRUE(whole.object);
  EXPECT_EQ(whole.object->id, ground->id);
  EXPECT_THAT(whole.note, ::testing::IsEmpty()) << "it has a decision of its own";
  const std::string expected = withoutFolder(textOf(whole, rules, map->scene()), inputs);
  EXPECT_THAT(explainThing(*map, ground->id.hex(), false), ::testing::EndsWith(expected));
  // All at once tells the same.
  auto alone = nlohmann::ordered_json::parse(explainThing(*map, ground->id.hex(), true));
  alone.erase("number"), alone.erase("thing");
  EXPECT_EQ(nlohmann::ordered_json::parse(explainObjects(*map)[ground - objects.begin()]), alone);
}

TEST_F(ExplanationOfALongMap, ReadsSomeTilesAndSaysWhatTheWholeMapSays) {
  build();
  std::size_t in_part = 0;
  for (std::size_t i = 0; i < map->objects().size(); i += 7) {
    const SemanticObject& object = map->objects()[i];
    if (object.is_class_wide) continue;
    const auto whole = explain(map->scene(), rules, {}, object);
    ASSERT_TRUE(whole);
    const std::string expected = withoutFolder(textOf(*whole, rules, map->scene()), inputs);
    EXPECT_TRUE(explainThing(*map, object.id.hex(), false).ends_with(expected)) << "object " << i;
    if (map->partAroundObject(object.id, {1, 5})) ++in_part;
  }
  EXPECT_GE(in_part, 5U);
}

/// Whether one of the parts that are tried tells why the object is not of the class.
bool isToldInPart(const MapReader& map, const SemanticObject& object, const RuleSet& rules,
                  const std::string& class_iri) {
  const double reach_m = localReach(rules).reach_m.value();
  for (const LayersAround& around : {LayersAround{4, 0}, {7, 2}, {13, 4}}) {
    const auto part = map.partOfLayers(map.placeOfObject(object.id), rules, reach_m, around);
    if (!part) return false;
    std::vector<char> is_dirty(part->scene.primitives.size(), 0);
    for (const SemanticObject& other : part->objects)
      if (other.id == object.id)
        for (const PrimitiveIndex primitive : primitivesOf(other)) is_dirty[primitive] = 1;
    const LocalInput window{part->scene, is_dirty, part->is_open, {}, {part->traces.begin(), part->traces.end()}};
    if (considerIn(window, rules, {}, class_iri, reach_m)) return true;
  }
  return false;
}

/// Why a thing is of no other class is told from some tiles, too.
TEST_F(ExplanationOfALongMap, WhyNotReadsSomeTilesAndSaysWhatTheWholeMapSays) {
  build({.seed = 5,
         .stops = isLong() ? 30.0 : 20.0,
         .size_m = isLong() ? 400.0 : 270.0,
         .points_per_stop = 5000,
         .max_range_m = 16,
         .stop_distance_m = 20});
  const ReasoningResult made = reason(map->scene(), rules);
  constexpr std::array<const char*, 3> kClasses{"StreetLamp", "Building", "SmallObject"};
  std::size_t in_part = 0, number = 0;
  for (const SemanticObject& object : map->objects()) {
    if (object.is_class_wide || in_part == 6) continue;
    const auto owner = std::find_if(made.objects.begin(), made.objects.end(),
                                    [&](const SemanticObject& other) { return other.id == object.id; });
    ASSERT_NE(owner, made.objects.end());
    const std::string asked = kClasses[number++ % kClasses.size()], class_iri = classNamed(*map, asked);
    if (!isToldInPart(*map, object, rules, class_iri)) continue;
    ++in_part;
    auto said = considerFor(map->scene(), rules, {}, class_iri, primitivesOf(object));
    const std::string expected = textOf(whyNot(std::move(said), rules, made, &*owner, class_iri), rules);
    const std::string told = explainWhyNot(*map, object.id.hex(), asked).text;
    EXPECT_TRUE(told.ends_with(withoutFolder(expected, inputs))) << told << "\nis not\n" << expected;
  }
  EXPECT_EQ(in_part, 6U);
}

std::vector<std::string> explainedWith(const MapReader& map, const ExplainedCluxels& most) {
  std::vector<std::string> lines;
  forEachExplanation(
      map, [&](std::string_view line) { lines.emplace_back(line); }, most);
  return lines;
}

TEST_F(ExplanationOfALongMap, OfAllObjectsIsTheSameRegionByRegion) {
  build();
  const std::vector<std::string> whole = explainObjects(*map);
  const std::size_t all = map->scene().cluxels.size();
  EXPECT_EQ(explainedWith(*map, {all, 1}), whole) << "at once";
  for (const std::size_t region : {std::size_t{1}, all / 20, all / 4, all})
    EXPECT_EQ(explainedWith(*map, {0, region}), whole) << region;
}

TEST_F(ExplanationOfALongMap, ASingleTileExplainsOnlyWhatItDecidesAsTheMapDid) {
  build();
  const std::vector<std::string> whole = explainObjects(*map);
  std::size_t asked_about = 0, told_about = 0;
  for (const TileKey& tile : storedTiles(map->transaction())) {
    TileStages stages(map->model(), inputs.params);
    const auto part = partOfMap(map->transaction(), stages, {tile}, 0);
    ASSERT_TRUE(part);
    std::vector<AskedObject> asked;
    for (const SemanticObject& object : part->objects)
      if (!object.is_class_wide) asked.push_back({object.id, primitivesOf(object)});
    const auto told = explainInPart(part->scene, rules, {part->traces, part->objects}, asked);
    ASSERT_EQ(told.size(), asked.size());
    asked_about += asked.size();
    for (std::size_t i = 0; i < told.size(); ++i) {
      if (!told[i]) continue;
      ++told_about;
      Explanation explanation = *told[i];
      shortenFiles(explanation, inputs);
      const std::string line = nlohmann::ordered_json::parse(jsonOf(explanation, rules, part->scene)).dump();
      const auto& ids = map->objectIds();
      const auto number = std::lower_bound(ids.begin(), ids.end(), asked[i].id) - ids.begin();
      EXPECT_EQ(line, whole.at(static_cast<std::size_t>(number)));
    }
  }
  EXPECT_GE(told_about, 5U);
  EXPECT_LT(told_about, asked_about) << "objects that the border cuts were explained";
}

TEST(Explanation, OfAllObjectsAsksTheWholeMapWhereRulesDo) {
  const ScratchFolder folder;
  const MapReader map(buildAskingMap(folder.path()));
  EXPECT_EQ(explainedWith(map, {0, 1}), explainObjects(map));
}

TEST(Explanation, TakesTheNumberOfAnObjectAndSaysIt) {
  const MapReader& map = CampusMap::shared().map();
  const std::string by_hash = explainThing(map, map.objects().at(1).id.hex(), false);
  EXPECT_EQ(explainThing(map, "1", false), by_hash);
  EXPECT_EQ(explainThing(map, "#1", false), by_hash);
  EXPECT_TRUE(by_hash.starts_with("object #1\n")) << by_hash;
  EXPECT_EQ(nlohmann::json::parse(explainThing(map, "#1", true)).at("number"), 1);
  EXPECT_THROW(explainThing(map, "#" + std::to_string(map.objects().size()), false), Error);
  EXPECT_THROW(explainThing(map, "#one", false), Error);
}

TEST(Explanation, NamesRuleFilesWithoutTheFoldersOfTheMachine) {
  const MapReader& map = CampusMap::shared().map();
  for (const char* name : {"0", "1", "2"}) {
    const std::string text = explainThing(map, name, false);
    EXPECT_THAT(text, HasSubstr("[outdoor.rules.yaml:"));
    EXPECT_THAT(text, ::testing::Not(HasSubstr(test::sourceFolder().string())));
  }
}

TEST(Explanation, TakesAPrimitiveByItsIri) {
  const MapReader& map = CampusMap::shared().map();
  const Primitive& primitive = map.scene().primitives.front();
  EXPECT_THAT(explainThing(map, rdf::iriOfPrimitive(primitive.id), false),
              HasSubstr("primitive " + primitive.id.hex()));
}

TEST(Explanation, TakesNamesAsAnswersToQueriesWriteThem) {
  const MapReader& map = CampusMap::shared().map();
  const std::string hex = map.objects().front().id.hex();
  const std::string told = explainThing(map, hex, false);
  EXPECT_EQ(explainThing(map, "map:object/" + hex, false), told) << "as in a table";
  EXPECT_EQ(explainThing(map, "<https://w3id.org/cluxel/map/object/" + hex + ">", false), told)
      << "as in TSV and Turtle";
  EXPECT_EQ(explainThing(map, "https://w3id.org/cluxel/map/object/" + hex + "\r\n", false), told) << "a line of CSV";
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
  // The small object was made after the bench: asked of the finished map, the rule would find it and reject the bench.
  ASSERT_EQ(map.summary().objects_by_class.count("Bench"), 1U);
  ASSERT_EQ(map.summary().objects_by_class.count("SmallObject"), 1U);
  for (const SemanticObject& object : map.objects()) {
    const std::string text = explainThing(map, object.id.hex(), false);
    EXPECT_THAT(text, HasSubstr("belongs to clx:" + localName(object.class_iri) + " " + object.id.hex()));
  }
}

}  // namespace
}  // namespace cluxel::tasks
