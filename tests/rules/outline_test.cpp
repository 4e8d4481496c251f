// SPDX-License-Identifier: Apache-2.0
// Outlines of unions against outlines of all cluxels, and shapes against plain definitions.
#include "rules/propose/outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "perception/segments/component_tile.hpp"
#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// Some of the scene's cluxels, ascending.
std::vector<std::uint32_t> someOf(const Scene& scene, std::mt19937& random, double share) {
  std::bernoulli_distribution takes(share);
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < scene.cluxels.size(); ++i)
    if (takes(random)) some.push_back(i);
  return some;
}

TEST(Outline, OfAUnionIsThatOfAllCluxels) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  std::mt19937 random(4);
  for (const double share : {0.01, 0.1, 0.6}) {
    const std::vector<std::uint32_t> all = someOf(scene, random, share);
    std::vector<std::vector<std::uint32_t>> sets(3);
    for (const std::uint32_t cluxel : all) sets[random() % 3].push_back(cluxel);
    std::vector<Outline> parts;
    std::vector<const Outline*> pointers;
    for (const auto& set : sets) parts.push_back(outlineOf(scene.cluxels, set));
    for (const Outline& part : parts) pointers.push_back(&part);
    const Outline merged = unionOf(pointers), whole = outlineOf(scene.cluxels, all);
    EXPECT_EQ(merged.hull, whole.hull);
    EXPECT_EQ(merged.min, whole.min);
    EXPECT_EQ(merged.max, whole.max);
    EXPECT_EQ(merged.bottom, whole.bottom);
    EXPECT_EQ(merged.top, whole.top);
    EXPECT_EQ(merged.cluxels, whole.cluxels);
  }
}

TEST(Outline, SetsTheAttributesThatItClaims) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  std::mt19937 random(5);
  const std::vector<std::uint32_t> cluxels = someOf(scene, random, 0.2);
  const Shape shape = shapeOfCluxels(scene, cluxels, {}, {});
  Shape outlined;
  outlined.attributes.fill(std::nan(""));
  setAttributes(outlineOf(scene.cluxels, cluxels), outlined);
  for (std::size_t i = 0; i < kAttributeCount; ++i)
    if (const auto attribute = static_cast<Attribute>(i); isOfOutline(attribute))
      EXPECT_EQ(outlined[attribute], shape[attribute]) << attributeInfos()[i].name;
    else
      EXPECT_TRUE(std::isnan(outlined[attribute])) << attributeInfos()[i].name;
}

TEST(Shape, HasTheFootprintAndTheMedianHeightOfItsCluxels) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  std::mt19937 random(6);
  // Few far apart, which are counted by sorting, and many, which are counted by a bitmap.
  for (const double share : {0.0005, 0.02, 0.5}) {
    const std::vector<std::uint32_t> cluxels = someOf(scene, random, share);
    ASSERT_FALSE(cluxels.empty());
    std::set<std::pair<double, double>> cells;
    std::vector<double> heights;
    for (const std::uint32_t i : cluxels) {
      const Eigen::Vector2d half = scene.cluxels.extent[i].head<2>().cast<double>() / 2;
      const Eigen::Vector2d low = ((scene.cluxels.center[i].head<2>() - half) / kFootprintCell_m).array().floor();
      const Eigen::Vector2d high = ((scene.cluxels.center[i].head<2>() + half) / kFootprintCell_m).array().floor();
      for (double x = low.x(); x <= high.x(); ++x)
        for (double y = low.y(); y <= high.y(); ++y) cells.emplace(x, y);
      for (std::uint32_t n = 0; n < std::max(1U, static_cast<std::uint32_t>(scene.cluxels.point_count[i])); ++n)
        heights.push_back(static_cast<double>(scene.cluxels.height_above_ground[i]));
    }
    std::sort(heights.begin(), heights.end());
    const Shape shape = shapeOfCluxels(scene, cluxels, {}, {});
    EXPECT_DOUBLE_EQ(shape[Attribute::FootprintArea],
                     static_cast<double>(cells.size()) * kFootprintCell_m * kFootprintCell_m);
    EXPECT_EQ(shape[Attribute::FreeHeightBelow], heights[(heights.size() + 1) / 2 - 1]);
  }
}

}  // namespace
}  // namespace cluxel::testing
