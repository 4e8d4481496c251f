// SPDX-License-Identifier: Apache-2.0
// Thresholds that stay within their margins change nothing, and margins are no narrower than what was measured.
#include "rules/decide/threshold_margins.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "base/file_bytes.hpp"
#include "rules/local_run_fixture.hpp"
#include "rules/other_number.hpp"
#include "rules/reasoning_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {
namespace {

struct NotedRun {
  ReasoningResult result;
  TileMargins margins;
};

NotedRun runOf(const Scene& scene, const RuleSet& rules, unsigned threads = 1) {
  ThresholdMargins margins(scene, rules);
  ReasoningContext context;
  context.threads = threads;
  context.margins = &margins;
  NotedRun run;
  run.result = reason(scene, rules, context);
  run.margins = margins.found();
  return run;
}

std::string shippedText() {
  return readFile(test::sourceFolder() / "rules/outdoor.rules.yaml");
}

/// Whether what turned out otherwise lies around what `beyond` tells, as a run around it finds.
void expectChangesAround(const Scene& scene, const NotedRun& before, const NotedRun& after, const TileSet& beyond,
                         const RuleSet& changed, double reach_m) {
  std::vector<char> is_dirty(scene.primitives.size(), 0);
  for (std::uint32_t c = 0; c < scene.cluxels.size(); ++c)
    if (beyond.contains(scene.cluxels.name[c].tile)) is_dirty[scene.cluxels.primitive[c]] = 1;
  const std::vector<char> is_open(is_dirty.size(), 0);
  const std::vector<std::optional<std::uint64_t>> stored(before.result.traces.begin(), before.result.traces.end());
  const auto outcome = decideLocally({scene, is_dirty, is_open, {}, stored}, changed, {}, reach_m);
  if (!outcome) return;
  for (std::size_t i = 0; i < is_dirty.size(); ++i)
    if (outcome->layer[i] > kLastDecidedLayer) {
      ASSERT_EQ(after.result.traces[i], before.result.traces[i]) << "layer " << outcome->layer[i];
    }
}

/// What became of random changes, by kind of number.
struct Kept {
  std::size_t tried = 0, kept = 0, decided_otherwise = 0, other_structure = 0;
};

TEST(ThresholdMargins, TellWhereOtherNumbersDecideNothingOtherwise) {
  std::mt19937 random(3);
  const std::string text = shippedText();
  const RuleSet rules = loadText(text).require();
  const double reach_m = localReach(rules).reach_m.value();
  std::map<std::string, Kept> of_kind;
  const int changes = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 400 : 35;
  for (int street = 0; street < 6; ++street) {
    const Scene scene = sceneOfBoxes(randomStreet(random, 200, street < 3 ? 0.15 : 0.5)).scene;
    const NotedRun before = runOf(scene, rules);
    EXPECT_TRUE(tilesBeyond(before.margins, rules.constants, rules).empty()) << "the same rules decide the same";
    for (int change = 0; change < changes; ++change) {
      const test::OtherNumber other = test::withOtherNumber(text, random);
      SCOPED_TRACE(other.what + ", street " + std::to_string(street));
      LoadedRules loaded = loadText(other.text);
      if (!loaded.rules) continue;
      const RuleSet changed = std::move(loaded).require();
      Kept& kept = of_kind[other.what.substr(0, other.what.find(':'))];
      ++kept.tried;
      if (changed.structure != rules.structure) {
        ++kept.other_structure;
        continue;
      }
      const NotedRun after = runOf(scene, changed);
      kept.decided_otherwise += after.result.traces != before.result.traces ? 1 : 0;
      const TileSet beyond = tilesBeyond(before.margins, rules.constants, changed);
      if (beyond.empty()) {
        ++kept.kept;
        ASSERT_EQ(after.result.traces, before.result.traces);
        ASSERT_EQ(objectsIn(scene, after.result, changed), objectsIn(scene, before.result, rules));
      } else {
        expectChangesAround(scene, before, after, beyond, changed,
                            std::max(reach_m, localReach(changed).reach_m.value()));
        if (HasFatalFailure()) return;
      }
    }
  }
  std::size_t decided_otherwise = 0;
  for (const auto& [kind, kept] : of_kind) {
    RecordProperty(kind, std::to_string(kept.kept) + " of " + std::to_string(kept.tried) + " kept");
    decided_otherwise += kept.decided_otherwise;
    if (kind != "constant" && kind != "confidence") {  // of slices, and of the ground
      EXPECT_EQ(kept.other_structure, 0U) << kind;
    }
    EXPECT_GE(kept.kept, 1U) << kind;
  }
  EXPECT_EQ(of_kind.size(), test::kindsOfNumbers().size());
  EXPECT_GE(decided_otherwise, 5U);
}

TEST(ThresholdMargins, DoNotDependOnThreads) {
  std::mt19937 random(4);
  const RuleSet rules = loadText(shippedText()).require();
  const Scene scene = sceneOfBoxes(randomStreet(random, 200, 0.5)).scene;
  EXPECT_EQ(runOf(scene, rules).margins, runOf(scene, rules, 3).margins);
}

TEST(ThresholdMargins, AreTheNearestMeasuredNumbers) {
  const auto rules = [](const std::string& test) {
    return rulesOf("[clx:SmallObject]", R"(
  - id: tall
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree: { test: )" + test + ", yes: { accept: { confidence: 0.9 } }, no: { reject: too low } }\n");
  };
  BoxScene boxes;
  for (const double height : {1.0, 2.0, 3.0})
    boxes.boxes.push_back(
        box("thing" + std::to_string(height), kSmall, {6 * height, 2, height / 2}, {0.5, 0.5, height}));
  const Scene scene = sceneOfBoxes(boxes).scene;
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"height >= 2 m", {"height >= 1.001 m", "height >= 2 m"}},
      {"height < 2 m", {"height < 1.001 m", "height < 2 m"}},
      {"height > 2 m", {"height > 2 m", "height > 2.999 m"}},
      {"height <= 2 m", {"height <= 2 m", "height <= 2.999 m"}},
      {"height >= 2.5 m", {"height >= 2.001 m", "height >= 2.999 m"}}};
  const std::vector<std::pair<std::string, std::string>> beyond = {{"height >= 2 m", "height >= 2.001 m"},
                                                                   {"height >= 2 m", "height >= 0.999 m"},
                                                                   {"height < 2 m", "height < 2.001 m"},
                                                                   {"height > 2 m", "height > 1.999 m"},
                                                                   {"height <= 2 m", "height <= 3.001 m"}};
  const auto beyondOf = [&](const std::string& test, const std::string& other) {
    const RuleSet before = rules(test);
    return tilesBeyond(runOf(scene, before).margins, before.constants, rules(other));
  };
  for (const auto& [test, allowed] : cases)
    for (const std::string& other : allowed) EXPECT_TRUE(beyondOf(test, other).empty()) << test << ", " << other;
  for (const auto& [test, other] : beyond) EXPECT_EQ(beyondOf(test, other).size(), 1U) << test << ", " << other;
}

/// Three things of 1, 2 and 3 m, of half a metre in plan view.
TEST(ThresholdMargins, OfRangesRatiosAndConfidencesAreTheNearestNumbers) {
  const auto rules = [](const std::string& test, const std::string& confidence = "0.9") {
    return rulesOf("[clx:SmallObject]", R"(
  - id: tall
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree: { test: )" + test + ", yes: { accept: { confidence: " +
                                            confidence + " } }, no: { reject: too low } }\n");
  };
  BoxScene boxes;
  for (const double height : {1.0, 2.0, 3.0})
    boxes.boxes.push_back(
        box("thing" + std::to_string(height), kSmall, {6 * height, 2, height / 2}, {0.5, 0.5, height}));
  const Scene scene = sceneOfBoxes(boxes).scene;
  const auto beyondOf = [&](const RuleSet& before, const RuleSet& other) {
    EXPECT_EQ(before.structure, other.structure);
    return tilesBeyond(runOf(scene, before).margins, before.constants, other).size();
  };
  const RuleSet range = rules("height between 1.5 m and 2.5 m"), ratio = rules("height >= 3 x width");
  for (const std::string within : {"between 1.1 m and 2.9 m", "between 1.9 m and 2.1 m"})
    EXPECT_EQ(beyondOf(range, rules("height " + within)), 0U) << within;
  for (const std::string beyond : {"between 0.9 m and 2.5 m", "between 1.5 m and 3.1 m", "between 2.1 m and 2.5 m"})
    EXPECT_EQ(beyondOf(range, rules("height " + beyond)), 1U) << beyond;
  for (const std::string within : {"2.1 x", "3.9 x"})
    EXPECT_EQ(beyondOf(ratio, rules("height >= " + within + " width")), 0U);
  for (const std::string beyond : {"1.9 x", "4.1 x"})
    EXPECT_EQ(beyondOf(ratio, rules("height >= " + beyond + " width")), 1U);
  EXPECT_EQ(beyondOf(range, rules("height between 1.5 m and 2.5 m", "0.8")), 1U) << "one thing is accepted";
  EXPECT_EQ(beyondOf(rules("height >= 5 m"), rules("height >= 5 m", "0.8")), 0U) << "nothing is accepted";
}

/// A thing, and a pole at some distance from it.
TEST(ThresholdMargins, OfSearchesReachAsFarAsTheSearch) {
  const auto rules = [](const std::string& distance) {
    return rulesOf("[clx:SmallObject]", R"(
  - id: beside
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree:
      find: { as: pole, label: column, where: [ gap to thing <= )" +
                                            distance + R"( ] }
      found: { accept: { confidence: 0.9 } }
      missing: { reject: alone }
)");
  };
  const auto isBeyond = [&](double gap_m, const std::string& distance, const std::string& other) {
    BoxScene boxes;
    boxes.boxes.push_back(box("thing", kSmall, {2, 2, 0.5}, {0.5, 0.5, 1}));
    boxes.boxes.push_back(box("pole", kColumn, {2.5 + gap_m, 2, 0.5}, {0.5, 0.5, 1}));
    const RuleSet before = rules(distance);
    return !tilesBeyond(runOf(sceneOfBoxes(boxes).scene, before).margins, before.constants, rules(other)).empty();
  };
  EXPECT_FALSE(isBeyond(0.8, "1 m", "0.9 m"));
  EXPECT_TRUE(isBeyond(0.8, "1 m", "0.7 m"));
  EXPECT_FALSE(isBeyond(1.15, "1 m", "1.1 m"));
  EXPECT_TRUE(isBeyond(1.15, "1 m", "1.2 m"));
  EXPECT_FALSE(isBeyond(9, "1 m", "1.2 m"));
  EXPECT_FALSE(isBeyond(9, "1 m", "0.1 m"));
  EXPECT_TRUE(isBeyond(9, "1 m", "1.4 m")) << "nobody looked so far";
}

/// Things in a row, and how far they are apart.
TEST(ThresholdMargins, OfGroupsLeaveOutWhatIsJoinedAnyway) {
  const auto rules = [](const std::string& group) {
    return rulesOf("[clx:SmallObject]", R"(
  - id: row
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    group: { )" + group + R"( }
    tree: { test: length >= 0.1 m, yes: { accept: { confidence: 0.9 } }, no: { reject: no } }
)");
  };
  const auto isBeyond = [&](const std::vector<double>& gaps, const std::string& group, const std::string& other) {
    BoxScene boxes;
    double x = 1;
    boxes.boxes.push_back(box("first", kSmall, {x, 2, 0.5}, {0.5, 0.5, 1}));
    for (const double gap : gaps) {
      x += 0.5 + gap;
      boxes.boxes.push_back(box("after" + std::to_string(x), kSmall, {x, 2, 0.5}, {0.5, 0.5, 1}));
    }
    const RuleSet before = rules(group);
    return !tilesBeyond(runOf(sceneOfBoxes(boxes).scene, before).margins, before.constants, rules(other)).empty();
  };
  EXPECT_FALSE(isBeyond({1.15}, "near: 1 m", "near: 1.1 m"));
  EXPECT_TRUE(isBeyond({1.15}, "near: 1 m", "near: 1.2 m"));
  EXPECT_TRUE(isBeyond({9}, "near: 1 m", "near: 1.4 m")) << "nobody looked so far";
  EXPECT_FALSE(isBeyond({0.8}, "near: 1 m", "near: 0.9 m"));
  EXPECT_TRUE(isBeyond({0.8}, "near: 1 m", "near: 0.7 m"));
  EXPECT_FALSE(isBeyond({0.3, 0.3}, "near: 1 m", "near: 1.2 m")) << "the outer two are 1.1 m apart";
  EXPECT_FALSE(isBeyond({0.3, 0.3}, "near: 1.2 m", "near: 1 m"));
  const auto stacked = [](double horizontal_m) {
    return "horizontal: " + std::to_string(horizontal_m) + " m, vertical: 1 m";
  };
  EXPECT_FALSE(isBeyond({1.15}, stacked(1), stacked(1.1)));
  EXPECT_TRUE(isBeyond({1.15}, stacked(1), stacked(1.2)));
  EXPECT_FALSE(isBeyond({0.8}, stacked(1), stacked(0.9)));
  EXPECT_TRUE(isBeyond({0.8}, stacked(1), stacked(0.7)));
  EXPECT_TRUE(isBeyond({9}, stacked(1), stacked(1.4))) << "nobody looked so far";
}

TEST(RuleStructure, ChangesWithAllThatNoMarginTells) {
  const std::string text = shippedText();
  const RuleSet rules = loadText(text).require();
  const auto structureWith = [&](const std::string& old_text, const std::string& new_text) {
    std::string changed = text;
    const std::size_t place = changed.find(old_text);
    EXPECT_NE(place, std::string::npos) << old_text;
    return loadText(changed.replace(place, old_text.size(), new_text)).require().structure;
  };
  for (const auto& [old_text, new_text] : std::vector<std::pair<std::string, std::string>>{
           {"machine_made: [ height >= 3 m", "machine_made: [ height >= 3.5 m"},
           {"# SPDX", "# Another comment.\n# SPDX"},
           {"gap to top <= 1.2 m", "gap to top <= 1.3 m"},
           {"top >= 0.9 x top of trunk", "top >= 0.8 x top of trunk"},
           {"max_fraction_of_points: 0.3", "max_fraction_of_points: 0.2"},
           {"group: { near: 1.5 m }", "group: { near: 1.4 m }"},
           {"confidence: 0.75", "confidence: 0.7"},
           {"height between 0.2 m and 1.2 m", "height between 0.3 m and 1.3 m"}})
    EXPECT_EQ(structureWith(old_text, new_text), rules.structure) << new_text;
  for (const auto& [old_text, new_text] : std::vector<std::pair<std::string, std::string>>{
           {"machine_made: [ height >= 3 m", "machine_made: [ height > 3 m"},
           {"machine_made: [ height >= 3 m", "machine_made: [ length >= 3 m"},
           {"merge_into: class, confidence: 0.98", "merge_into: class, confidence: 0.97"},
           {"from 0.2 m to 1.3 m <= 0.25 m", "from 0.2 m to 1.4 m <= 0.25 m"},
           {"clearance: $crown_clearance", "clearance: 0.7 m"}})
    EXPECT_NE(structureWith(old_text, new_text), rules.structure) << new_text;
}

}  // namespace
}  // namespace cluxel::testing
