// SPDX-License-Identifier: Apache-2.0
// Other rules, models and ontologies give the map of a build with them.
#include <gtest/gtest.h>

#include <tuple>

#include "mapping/map_change_fixture.hpp"

namespace cluxel::mapping {
namespace {

class InputsChange : public MapChange {};

TEST_F(InputsChange, OtherRulesGiveTheBuildWithTheseRules) {
  build({{0, 0}, {1, 0}});
  MapInputs other = *inputs;
  std::string& text = other.rules.front().text;
  // Patches of ground that are farther apart become objects of their own.
  const std::pair<std::string, std::string> changes[] = {{"group: { near: 1.5 m }", "group: { near: 0.2 m }"},
                                                         {"merge_into: class, confidence: 0.98", "confidence: 0.98"},
                                                         {"merge_into: class, confidence: 0.80", "confidence: 0.80"}};
  for (const auto& [before, after] : changes) {
    ASSERT_NE(text.find(before), std::string::npos) << before;
    text.replace(text.find(before), before.size(), after);
  }
  buildMap(posed({{0, 0}, {1, 0}}), other, folder.path() / "other.clx", {}, silence());
  // At once, and in strips that give way to the whole map because the ground is of another kind.
  for (const std::uint64_t cluxels : {UpdateParams{}.whole_cluxels, std::uint64_t{10}}) {
    const ChangeReport report = applyInputs(map(), always(other), {.whole_cluxels = cluxels}, silence());
    EXPECT_FALSE(report.objects.isEmpty());
    EXPECT_EQ(report.tiles_changed, 0U);
    EXPECT_TRUE(canonicalText(map()) == canonicalText(folder.path() / "other.clx")) << cluxels;
    applyInputs(map(), always(*inputs), {.whole_cluxels = cluxels}, silence());
    expectExact({{0, 0}, {1, 0}});
  }
}

TEST_F(InputsChange, OtherSparqlRulesAndLabelsAreInferredAlone) {
  MapInputs other = *inputs;
  other.sparql_rules.erase(other.sparql_rules.begin());
  other.ontology.back().text += "\nclx:Tree rdfs:label \"Baum\"@de .\n";
  MapInputs with_other_number = other;
  std::string& text = with_other_number.rules.front().text;
  text.replace(text.find("group: { near: 1.5 m }"), 22, "group: { near: 1.4 m }");
  MapInputs with_class = other;
  with_class.ontology.back().text += "\nclx:Hut a owl:Class ; rdfs:subClassOf clx:Building .\n";
  for (const MapInputs& inputs_now : {other, with_other_number, with_class}) {
    build({{0, 0}, {1, 0}});
    const ChangeReport report = applyInputs(map(), always(inputs_now), {.max_window_share = 2}, silence());
    buildMap(posed({{0, 0}, {1, 0}}), inputs_now, folder.path() / "other.clx", {.force = true}, silence());
    EXPECT_TRUE(contentOf(map()) == contentOf(folder.path() / "other.clx"));
    const bool may_name_another_class = inputs_now.ontology == with_class.ontology;
    if (inputs_now.rules == other.rules) {
      EXPECT_EQ(report.tiles_decided, may_name_another_class ? report.tiles : 0U);
    }
    applyInputs(map(), always(*inputs), {.max_window_share = 2}, silence());
    expectExact({{0, 0}, {1, 0}});
  }
}

TEST_F(InputsChange, AnotherModelGivesTheBuildWithThisModel) {
  MapInputFiles files;
  files.model = "campus";
  const MapInputs other = readMapInputs(files, DataHome(test::sourceFolder()));
  buildMap(posed({{0, 0}, {1, 0}}), other, folder.path() / "other.clx", {}, silence());
  const Content expected = contentOf(folder.path() / "other.clx");
  ChangeReport whole;
  for (const std::uint64_t part_points : {100'000U, 1'000U, 1U}) {  // the map has 2400 points
    build({{0, 0}, {1, 0}});
    const ChangeParams params{.threads = 2, .stage_points = part_points, .max_window_share = 2};
    const ChangeReport report = applyInputs(map(), always(other), params, silence());
    EXPECT_TRUE(contentOf(map()) == expected) << "parts of " << part_points;
    if (part_points > 10'000) whole = report;
    EXPECT_EQ(report.local_commits, part_points > 10'000 ? 0U : 1U);
    EXPECT_EQ(report.objects.added, whole.objects.added);
    EXPECT_EQ(report.objects.gone, whole.objects.gone);
    EXPECT_EQ(report.objects.unchanged, whole.objects.unchanged);
  }
}

/// How many objects have the same id in both maps, and other parts, another rule or another confidence.
std::size_t redecidedBetween(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto decisionsOf = [](const std::filesystem::path& file) {
    std::map<ContentHash, std::tuple<std::string, double, std::map<std::uint32_t, std::string>>> decisions;
    const MapReader map(file);
    for (const rules::SemanticObject& object : map.objects()) {
      if (object.is_class_wide) continue;
      auto& [rule, confidence, part_of] = decisions[object.id];
      rule = object.rule_id, confidence = object.confidence;
      for (const rules::ObjectPart& part : object.parts)
        for (const std::uint32_t cluxel : part.cluxels) part_of[cluxel] = part.part_class;
    }
    return decisions;
  };
  const auto before = decisionsOf(a), after = decisionsOf(b);
  return static_cast<std::size_t>(std::count_if(before.begin(), before.end(), [&](const auto& object) {
    const auto same = after.find(object.first);
    return same != after.end() && same->second != object.second;
  }));
}

std::string replacedAll(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

TEST_F(InputsChange, ObjectsThatAreDecidedOtherwiseAreReported) {
  const SmallCampus dense({.seed = 5, .stops = 2, .size_m = 45, .points_per_stop = 15000});
  buildMap(scansOf(dense.files()), *inputs, map(), {}, silence());
  const std::filesystem::path before = folder.path() / "before.clx";
  std::filesystem::copy_file(map(), before);
  const std::string shipped = inputs->rules.front().text;
  const std::string swapped =
      replacedAll(shipped, "{ trunk: clx:TreeTrunk, top: clx:TreeTop }", "{ trunk: clx:TreeTop, top: clx:TreeTrunk }");
  const std::string surer = replacedAll(shipped, "confidence: { from: 0.8,", "confidence: { from: 0.7,");
  for (const std::string& text : {swapped, surer, shipped}) {
    MapInputs other = *inputs;
    other.rules.front().text = text + "\n# others\n";
    buildMap(scansOf(dense.files()), other, folder.path() / "other.clx", {.force = true}, silence());
    const std::size_t expected = redecidedBetween(before, folder.path() / "other.clx");
    EXPECT_EQ(expected > 0, text != shipped);
    // In a window, at once, and in strips.
    const ChangeParams params[] = {{.dry_run = true, .max_window_share = 2},
                                   {.dry_run = true, .max_window_share = 0},
                                   {.dry_run = true, .max_window_share = 0, .whole_cluxels = 10}};
    for (const ChangeParams& how : params) {
      const ChangeReport report = applyInputs(map(), always(other), how, silence());
      EXPECT_EQ(report.objects.redecided.size(), expected);
      EXPECT_EQ(report.objects.unchanged + report.objects.redecided.size() + report.objects.added.size() +
                    report.objects.changed.size() + report.objects.split.size() + report.objects.joined.size(),
                report.object_count);
      for (const RedecidedObject& object : report.objects.redecided) {
        EXPECT_EQ(object.before.id, object.after.id);
        EXPECT_FALSE(object.after.class_iri.empty());
      }
    }
  }
}

}  // namespace
}  // namespace cluxel::mapping
