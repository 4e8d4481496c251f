// SPDX-License-Identifier: Apache-2.0
// Look-ups around many cluxels at once give what all pairs give.
#include "rules/objects/fragment_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace perception;
using namespace rules;
namespace {

double gapBetweenAll(const SceneCluxels& all, std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t one : a)
    for (const std::uint32_t other : b) smallest = std::min(smallest, gapBetween(all, one, other).gap());
  return smallest;
}

TEST(CluxelGrid, FindsAllPrimitivesNearSeveralCluxels) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const CluxelGrid grid(scene.cluxels);
  for (const double within_m : {0.0, 0.4, 3.0})
    for (std::size_t from = 0; from < scene.primitives.size(); from += 5) {
      std::vector<std::uint32_t> cluxels = scene.primitives[from].cluxels;
      const std::vector<std::uint32_t>& more = scene.primitives[(from * 7 + 3) % scene.primitives.size()].cluxels;
      cluxels.insert(cluxels.end(), more.begin(), more.end());  // two places, in no order
      const std::vector<PrimitiveIndex> found = grid.primitivesNear(cluxels, within_m);
      EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
      EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "each once";
      for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i) {
        if (gapBetweenAll(scene.cluxels, cluxels, scene.primitives[i].cluxels) > within_m) continue;
        EXPECT_TRUE(std::binary_search(found.begin(), found.end(), i)) << from << " " << i;
      }
    }
}

TEST(CluxelGrid, VisitsEachNearCluxelOnceInTheSameOrderHoweverTheyAreGiven) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const SceneCluxels& all = scene.cluxels;
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < all.size(); i += 2) some.push_back(i);
  const CluxelGrid grid(all, some);
  std::reverse(some.begin(), some.end());
  const CluxelGrid reversed(all, some);
  for (std::uint32_t from = 0; from < all.size(); from += 11)
    for (const double within_m : {0.0, 0.7}) {
      std::vector<std::uint32_t> found, again;
      grid.near(from, within_m, [&](std::uint32_t other) { found.push_back(other); });
      reversed.near(from, within_m, [&](std::uint32_t other) { again.push_back(other); });
      EXPECT_EQ(found, again);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "each once";
      for (const std::uint32_t other : some) {
        if (gapBetween(all, from, other).gap() > within_m) continue;
        EXPECT_TRUE(std::binary_search(found.begin(), found.end(), other)) << from << " " << other;
      }
    }
}

TEST(FragmentGaps, AreTheSmallestOfAllPairs) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const RuleSet rules = outdoorRules();
  const ReasoningContext context;
  const ReasoningState state(scene, rules, context);
  std::vector<FragmentIndex> all;
  for (FragmentIndex i = 0; i < state.fragments.size(); ++i) all.push_back(i);
  std::reverse(all.begin(), all.end());
  std::size_t near = 0;
  for (const double within_m : {0.0, 0.25, 2.0})
    for (FragmentIndex from = 0; from < all.size(); ++from) {
      const std::vector<std::uint32_t>& cluxels = state.fragments[from].cluxels;
      const std::vector<FragmentGap> gaps = gapsTo(state, cluxels, all, within_m);
      ASSERT_EQ(gaps.size(), all.size());
      for (FragmentIndex to = 0; to < gaps.size(); ++to) {
        EXPECT_EQ(gaps[to].fragment, to);
        const double expected = gapBetweenAll(scene.cluxels, cluxels, state.fragments[to].cluxels);
        if (expected > within_m) {
          EXPECT_GT(gaps[to].gap_m, within_m);
          continue;
        }
        EXPECT_EQ(gaps[to].gap_m, expected) << from << " " << to;
        near += from == to ? 0 : 1;
      }
    }
  EXPECT_GT(near, 20U) << "the street must have things that touch";
}

}  // namespace
}  // namespace cluxel::testing
