// SPDX-License-Identifier: Apache-2.0
// Thresholds that stay within their margins change nothing, and margins are no narrower than what was measured.
#include "rules/decide/threshold_margins.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "base/file_bytes.hpp"
#include "rules/local_run_fixture.hpp"
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

/// The text with one of its numbers after a comparison multiplied.
std::string withOtherThreshold(const std::string& text, std::mt19937& random) {
  static const std::regex kThreshold("[<>]=? ([0-9.]+)");
  const std::vector<std::smatch> found(std::sregex_iterator(text.begin(), text.end(), kThreshold),
                                       std::sregex_iterator());
  const std::smatch& match = found[random() % found.size()];
  const double factor = std::array{0.9, 0.97, 0.999, 1.001, 1.03, 1.1}[random() % 6];
  std::string changed = text;
  changed.replace(static_cast<std::size_t>(match.position(1)), static_cast<std::size_t>(match.length(1)),
                  std::to_string(std::stod(match.str(1)) * factor));
  return changed;
}

TEST(ThresholdMargins, TellWhereOtherThresholdsDecideNothingOtherwise) {
  std::mt19937 random(3);
  const std::string text = shippedText();
  const RuleSet rules = loadText(text).require();
  std::size_t kept = 0, other_structure = 0, decided_otherwise = 0;
  for (int street = 0; street < 4; ++street) {
    const Scene scene = sceneOfBoxes(randomStreet(random, 150, 0.3)).scene;
    const NotedRun before = runOf(scene, rules);
    for (int change = 0; change < 40; ++change) {
      LoadedRules loaded = loadText(withOtherThreshold(text, random));
      if (!loaded.rules) continue;
      const RuleSet changed = std::move(loaded).require();
      if (changed.structure != rules.structure) {
        ++other_structure;
        continue;
      }
      const NotedRun after = runOf(scene, changed);
      if (!tilesBeyond(before.margins, changed).empty()) {
        decided_otherwise += after.result.traces != before.result.traces ? 1 : 0;
        continue;
      }
      ++kept;
      ASSERT_EQ(after.result.traces, before.result.traces) << "street " << street << ", change " << change;
      ASSERT_EQ(objectsIn(scene, after.result, changed), objectsIn(scene, before.result, rules));
    }
  }
  EXPECT_GE(kept, 30U);
  EXPECT_GE(other_structure, 5U) << "distances are not told by margins";
  EXPECT_GE(decided_otherwise, 2U);
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
  for (const auto& [test, allowed] : cases)
    for (const std::string& other : allowed)
      EXPECT_TRUE(tilesBeyond(runOf(scene, rules(test)).margins, rules(other)).empty()) << test << ", " << other;
  for (const auto& [test, other] : beyond)
    EXPECT_EQ(tilesBeyond(runOf(scene, rules(test)).margins, rules(other)).size(), 1U) << test << ", " << other;
}

TEST(RuleStructure, ChangesWithAllButPlainThresholds) {
  const std::string text = shippedText();
  const RuleSet rules = loadText(text).require();
  const auto structureWith = [&](const std::string& old_text, const std::string& new_text) {
    std::string changed = text;
    const std::size_t place = changed.find(old_text);
    EXPECT_NE(place, std::string::npos) << old_text;
    return loadText(changed.replace(place, old_text.size(), new_text)).require().structure;
  };
  EXPECT_EQ(structureWith("machine_made: [ height >= 3 m", "machine_made: [ height >= 3.5 m"), rules.structure);
  EXPECT_EQ(structureWith("# SPDX", "# Another comment.\n# SPDX"), rules.structure);
  EXPECT_NE(structureWith("machine_made: [ height >= 3 m", "machine_made: [ height > 3 m"), rules.structure);
  EXPECT_NE(structureWith("machine_made: [ height >= 3 m", "machine_made: [ length >= 3 m"), rules.structure);
  EXPECT_NE(structureWith("gap to top <= 1.2 m", "gap to top <= 1.3 m"), rules.structure) << "how far rules look";
  EXPECT_NE(structureWith("top >= 0.9 x top of trunk", "top >= 0.8 x top of trunk"), rules.structure);
  EXPECT_NE(structureWith("max_fraction_of_points: 0.3", "max_fraction_of_points: 0.2"), rules.structure);
}

}  // namespace
}  // namespace cluxel::testing
