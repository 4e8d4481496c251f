// SPDX-License-Identifier: Apache-2.0
// Thresholds that lie within the noise of what a scene's things measure.
#include "rules/testing/threshold_noise.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// Columns from 2 m to 4 m high, far from each other.
BoxScene columnsOfManyHeights() {
  BoxScene boxes;
  for (int i = 0; i < 41; ++i) {
    const double height_m = 2 + 0.05 * i;
    boxes.boxes.push_back(box("p" + std::to_string(i), kColumn, {20.0 * i, 0, height_m / 2}, {0.3, 0.3, height_m}));
  }
  return boxes;
}

RuleSet poleRule(const std::string& test) {
  return rulesOf("[clx:Pole]", R"(
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree:
      )" + test + R"(
      yes: { accept: { confidence: 0.9 } }
      no: { reject: other }
)");
}

std::vector<NoisyThreshold> noisyIn(const std::string& test, const NoiseParams& params = {}) {
  const BuiltBoxScene built = sceneOfBoxes(columnsOfManyHeights());
  return thresholdsWithinNoise(built.scene, poleRule(test), {}, params);
}

TEST(ThresholdNoise, CountsTheThingsNearAThreshold) {
  const auto noisy = noisyIn("test: top >= 3 m");
  ASSERT_EQ(noisy.size(), 1u);
  EXPECT_EQ(noisy[0].test, "top of seed >= 3 m");
  EXPECT_EQ(noisy[0].tested, 41u);
  std::size_t near = 0;
  for (int i = 0; i < 41; ++i) near += std::abs(2 + 0.05 * i - 3) <= noisy[0].noise + 1e-6 ? 1 : 0;
  EXPECT_EQ(noisy[0].near, near);
  EXPECT_GT(noisy[0].noise, 0.05) << "a half without the highest cluxel ends a cluxel lower";
  EXPECT_LT(noisy[0].noise, 0.25);
}

TEST(ThresholdNoise, IsSilentWhereNothingIsNear) {
  EXPECT_TRUE(noisyIn("test: top >= 1 m").empty());
  EXPECT_TRUE(noisyIn("test: top >= 20 m").empty()) << "nothing measures about so much: the noise is unknown";
  EXPECT_TRUE(noisyIn("test: top >= 3 m", {.min_share = 0.9}).empty());
  EXPECT_TRUE(noisyIn("test: top >= 3 m", {.min_tests = 42}).empty());
}

TEST(ThresholdNoise, TakesTheWorseEndOfAnIntervalAndTestsWithinOthers) {
  const auto noisy = noisyIn("all: [ top between 3 m and 30 m, not: { attribute: top, op: \">\", value: 3.5 m } ]");
  ASSERT_EQ(noisy.size(), 2u);
  EXPECT_THAT((std::vector{noisy[0].test, noisy[1].test}),
              ::testing::UnorderedElementsAre("top of seed between 3 m and 30 m", "not top of seed > 3.5 m"));
}

TEST(ThresholdNoise, IsToldInTheUnitOfTheAttribute) {
  const auto warnings = warningsOf(noisyIn("test: top >= 3 m"));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].severity, Severity::Warning);
  EXPECT_FALSE(warnings[0].hint.empty());
  EXPECT_THAT(warnings[0].message, ::testing::MatchesRegex("pole: 'top of seed >= 3 m': [0-9]+ of 41 things that it "
                                                           "tests lie within the noise of 0\\.[0-9]+ m"));
}

}  // namespace
}  // namespace cluxel::testing
