// SPDX-License-Identifier: Apache-2.0
// A lesson changes the object that it is about and nothing else, or says so; its test passes; its cuts separate.
#include <gmock/gmock.h>

#include <random>
#include <set>

#include "base/file_bytes.hpp"
#include "base/quantile.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/language/rule_loader.hpp"
#include "rules/testing/rule_test.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/rule_reference/rule_reference.hpp"
#include "tasks/rule_teaching/lesson.hpp"
#include "tasks/rule_teaching/lesson_text.hpp"
#include "tasks/rule_teaching/separating_cuts.hpp"

namespace cluxel::tasks {
namespace {

using ::testing::HasSubstr;

std::set<ContentHash> idsOf(const std::vector<SemanticObject>& objects) {
  std::set<ContentHash> ids;
  for (const SemanticObject& object : objects) ids.insert(object.id);
  return ids;
}

std::vector<ContentHash> missingIn(const std::set<ContentHash>& some, const std::set<ContentHash>& all) {
  std::vector<ContentHash> missing;
  std::set_difference(some.begin(), some.end(), all.begin(), all.end(), std::back_inserter(missing));
  return missing;
}

bool testOfCasePasses(const MapReader& map, const Lesson& lesson, const std::filesystem::path& folder) {
  const MapInputs inputs = map.inputs();
  for (const NamedText& own : inputs.rules) writeFile(folder / std::filesystem::path(own.name).filename(), own.text);
  writeFile(folder / "taught.rules.yaml", lesson.rules);
  writeFile(folder / "taught.rules-test.yaml", lesson.test);
  return runRuleTests(folder / "taught.rules-test.yaml", classCatalogueOf(inputs.ontology)).passed();
}

TEST(RuleTeaching, ChangesTheObjectAndNothingElseOrSaysSo) {
  const MapReader& map = CampusMap::shared().map();
  const ScratchFolder folder;
  const std::set<ContentHash> before = idsOf(map.objects());
  std::size_t taught = 0, clean = 0, refused = 0, tested = 0;
  for (std::size_t i = 0; i < map.objects().size() && taught < 6; i += 5) {
    const bool is_sign = localName(map.objects()[i].class_iri) == "StreetSign";
    Lesson lesson;
    try {
      lesson = teach(map, {"#" + std::to_string(i), is_sign ? "Pole" : "StreetSign", {}, "taught.rules.yaml"});
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::InvalidArgument) << fault.what();
      ++refused;
      continue;
    }
    ++taught;
    EXPECT_LE(lesson.conditions.size(), 2U);
    AskReplay oracle(map);
    const RuleSet rules = rulesForMap(map, "taught.rules.yaml", lesson.rules);
    const ReasoningResult result = reason(map.scene(), rules, {.oracle = &oracle});
    const auto made = std::find_if(result.objects.begin(), result.objects.end(),
                                   [](const SemanticObject& object) { return object.rule_id.starts_with("taught/"); });
    ASSERT_NE(made, result.objects.end());
    EXPECT_EQ(localName(made->class_iri), lesson.class_name);
    const std::set<ContentHash> after = idsOf(result.objects);
    const bool only_it = missingIn(before, after) == std::vector{map.objects()[i].id} &&
                         missingIn(after, before) == std::vector{made->id};
    double points = 0, kept = 0;
    std::set<std::uint32_t> of_class;
    for (const SemanticObject& object : result.objects)
      if (localName(object.class_iri) == lesson.class_name)
        for (const std::uint32_t cluxel : cluxelsOf(object)) of_class.insert(cluxel);
    for (const std::uint32_t cluxel : cluxelsOf(map.objects()[i])) {
      points += map.scene().cluxels.point_count[cluxel];
      kept += of_class.contains(cluxel) ? map.scene().cluxels.point_count[cluxel] : 0;
    }
    EXPECT_EQ(lesson.points, points);
    EXPECT_EQ(lesson.kept_points, kept);
    EXPECT_TRUE(kept > 0.5 * points || !lesson.changesNothingElse());
    EXPECT_EQ(textOf(lesson).find("points of the object only") == std::string::npos, lesson.takesTheObject());
    if (lesson.changesNothingElse()) {
      EXPECT_TRUE(only_it) << "object " << i << " as " << textOf(lesson);
      ++clean;
    }
    tested += testOfCasePasses(map, lesson, folder.path()) ? 1 : 0;
    EXPECT_EQ(textOf(lesson).find("nothing else changes") != std::string::npos, lesson.changesNothingElse());
  }
  EXPECT_GE(taught, 3U);
  EXPECT_GE(clean, 1U);
  EXPECT_GE(2 * tested, taught) << "the test of a case fails where its neighbours matter, not in general";
}

TEST(RuleTeaching, RefusesWhatTheObjectIsAlready) {
  const MapReader& map = CampusMap::shared().map();
  const std::string own = localName(map.objects()[0].class_iri);
  EXPECT_THROW(teach(map, {"#0", own, {}, "taught.rules.yaml"}), Error);
  EXPECT_THROW(teach(map, {"#0", "Tre", {}, "taught.rules.yaml"}), Error);
  for (const char* no_class_of_objects : {"TreeTop", "Ground", "Object", "Region"})
    EXPECT_THROW(teach(map, {"#0", no_class_of_objects, {}, "taught.rules.yaml"}), Error) << no_class_of_objects;
}

TEST(RuleTeaching, LearnsWhatAnOperatorStated) {
  const MapReader& before = CampusMap::shared().map();
  const auto lessonFor = [](const MapReader& map, const std::string& object) -> std::optional<Lesson> {
    try {
      return teach(map, {object, "StreetSign", {}, "taught.rules.yaml"});
    } catch (const Error&) {
      return std::nullopt;
    }
  };
  std::size_t number = 0;
  std::optional<Lesson> expected;
  for (; !expected && number < before.objects().size(); ++number)
    if (localName(before.objects()[number].class_iri) != "StreetSign")
      expected = lessonFor(before, "#" + std::to_string(number));
  ASSERT_TRUE(expected);
  const SemanticObject& thing = before.objects()[number - 1];
  const ScratchFolder folder;
  const auto file = folder.path() / "stated.clx";
  std::filesystem::copy_file(CampusMap::shared().file(), file);
  const Statement sign{StatementKind::Is,
                       "",
                       Term::iri(rdf::vocabulary::clx("StreetSign")),
                       anchorOf(before.stagesWithPoints(), thing),
                       {}};
  const ChangeReport report = changeStatements(file, {{sign}, {}, ""}, {}, silence());
  ASSERT_EQ(report.statements.size(), 1U);
  const std::optional<Lesson> lesson = lessonFor(MapReader(file), report.statements[0].object->hex());
  ASSERT_TRUE(lesson);
  EXPECT_EQ(lesson->conditions, expected->conditions);
  EXPECT_EQ(lesson->before, expected->before);
}

AttributeValues valuesOf(double height, double roughness) {
  AttributeValues values{};
  values[static_cast<std::size_t>(Attribute::Height)] = height;
  values[static_cast<std::size_t>(Attribute::Roughness)] = roughness;
  return values;
}

TEST(SeparatingCuts, HoldForTheWantedAndForNoOther) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t separated = 0, refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<AttributeValues> wanted, others;
    for (int i = 0; i < 1 + round % 2; ++i) wanted.push_back(valuesOf(unit(random), unit(random)));
    for (int i = 0; i < 1 + round % 12; ++i) others.push_back(valuesOf(unit(random), unit(random)));
    const auto cuts = separatingCuts(wanted, others);
    ++(cuts ? separated : refused);
    if (!cuts) continue;
    EXPECT_LE(cuts->size(), 2U);
    const auto passes = [&](const AttributeValues& values) {
      return std::all_of(cuts->begin(), cuts->end(), [&](const AttributeCut& cut) { return cut.holds(values); });
    };
    EXPECT_TRUE(std::all_of(wanted.begin(), wanted.end(), passes));
    EXPECT_TRUE(std::none_of(others.begin(), others.end(), passes));
  }
  EXPECT_GT(separated, 50U);
  EXPECT_GT(refused, 10U);
}

TEST(SeparatingCuts, UseOneTestWhereOneIsEnough) {
  const std::vector wanted{valuesOf(3, 0.5)}, others{valuesOf(1, 0.4), valuesOf(1.5, 0.6), valuesOf(0.5, 0.5)};
  const auto cuts = separatingCuts(wanted, others);
  ASSERT_TRUE(cuts.has_value());
  ASSERT_EQ(cuts->size(), 1U);
  EXPECT_EQ(conditionText(cuts->front()), "height >= 2 m");
  EXPECT_FALSE(separatingCuts(std::vector{valuesOf(1, 0.4)}, std::vector{valuesOf(1, 0.4), valuesOf(2, 0.5)}));
}

TEST(RuleReference, HasEveryAttributeRelationAndRuleAndMeasuresClasses) {
  const MapReader& map = CampusMap::shared().map();
  const RuleSet rules =
      rulesForMap(map, "rules.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ outdoor.rules.yaml ]\n");
  MeasuredClasses measured;
  measured.add(map);
  const std::string text = referenceOf(rules, measured);
  for (const AttributeInfo& info : attributeInfos())
    EXPECT_THAT(text, HasSubstr("| `" + std::string(info.name) + "` |"));
  for (const RelationInfo& info : relationInfos()) EXPECT_THAT(text, HasSubstr("| `" + std::string(info.name) + "` |"));
  for (const Rule& rule : rules.rules) EXPECT_THAT(text, HasSubstr("#### " + rule.id + "\n"));
  std::size_t objects = 0;
  for (const auto& [name, values] : measured.values()) objects += values.size();
  EXPECT_EQ(objects, map.objects().size());
}

TEST(RuleTeaching, GivesRulesOfClassesWithOneLocalNameTheirOwnNames) {
  const MapReader& map = CampusMap::shared().map();
  const RuleSet rules = parseInputs(map.inputs()).rules;
  const auto idFor = [&](const std::string& class_iri) {
    LessonCase lesson{0, class_iri, "taught.rules.yaml", {0}, {}, {}, ""};
    const std::string text = ruleText(map, rules, lesson);
    EXPECT_THAT(text, HasSubstr("id: " + lesson.rule_id + "\n"));
    return lesson.rule_id;
  };
  const std::string own = idFor(rdf::vocabulary::clx("Tree"));
  EXPECT_EQ(own, "taught/tree-" + map.scene().primitives[0].id.hex().substr(0, 8));
  EXPECT_EQ(
      (std::set<std::string>{own, idFor("http://t.example/town#Tree"), idFor("http://t.example/store#Tree")}).size(),
      3U);
}

TEST(RuleTeaching, WritesAClassWithoutAPrefixAsRuleFilesTakeIt) {
  const MapReader& map = CampusMap::shared().map();
  const RuleSet rules = parseInputs(map.inputs()).rules;
  const ScratchFolder folder;
  const MapInputs inputs = map.inputs();
  for (const NamedText& own : inputs.rules)
    writeFile(folder.path() / std::filesystem::path(own.name).filename(), own.text);
  for (const std::string iri : {"http://t.example/town#Kiosk", "urn:x:Thing", "http://t.example/c/"}) {
    ClassCatalogue catalogue = classCatalogueOf(inputs.ontology);
    catalogue.classes.push_back({iri, {rdf::vocabulary::clx("Object")}, {}});
    LessonCase lesson{0, iri, "taught.rules.yaml", {0}, {}, {}, ""};
    writeFile(folder.path() / "taught.rules.yaml", ruleText(map, rules, lesson));
    writeFile(folder.path() / "taught.rules-test.yaml", testText(map, rules, lesson));
    const std::vector files{folder.path() / "taught.rules.yaml"};
    EXPECT_EQ(loadRules(files, catalogue, withCheckedQueries()).require().find(lesson.rule_id)->class_iri, iri);
    EXPECT_NO_THROW(runRuleTests(folder.path() / "taught.rules-test.yaml", catalogue)) << iri;
  }
}

TEST(RuleReference, QuantilesAreThoseOfSortedValues) {
  EXPECT_DOUBLE_EQ(quantileOf(std::vector<double>{1, 2, 3}, 0.5), 2);
  EXPECT_DOUBLE_EQ(quantileOf(std::vector<double>{4}, 0.95), 4);
  EXPECT_DOUBLE_EQ(quantileOf(std::vector<double>{0, 10}, 0.05), 0.5);
}

}  // namespace
}  // namespace cluxel::tasks
