// SPDX-License-Identifier: Apache-2.0
// Splitting crowns: against brute force, and where straight-line distance would be wrong.
#include "rules/objects/crown_splitting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "rules/cluxel_cloud.hpp"
#include "rules/propose/cluxel_grid.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// Shortest paths by Bellman-Ford: relax all edges until nothing changes.
std::vector<double> waysFrom(const SceneCluxels& all, std::uint32_t source, std::uint32_t first_crown) {
  std::vector<double> way(all.size(), std::numeric_limits<double>::infinity());
  way[source] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t i = 0; i < all.size(); ++i)
      for (std::uint32_t j : all.neighbours(i)) {
        if (j < first_crown || (i < first_crown && i != source)) continue;
        const double length = way[i] + (all.center[j] - all.center[i]).norm();
        if (length < way[j] - 1e-12) way[j] = length, changed = true;
      }
  }
  return way;
}

TEST(CrownSplitting, GivesEachCluxelToTheTrunkWithTheShortestWay) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 6), height(2, 5);
  int all_reached = 0;
  for (int round = 0; round < 10; ++round) {
    std::vector<Eigen::Vector3d> points{{1, 3, 2}, {5, 3, 2}};
    for (int i = 0; i < 150; ++i) points.emplace_back(place(random), place(random), height(random));
    const SceneCluxels all = cloudOf(points, 1.0);
    std::vector<std::uint32_t> crown;
    for (std::uint32_t i = 2; i < all.size(); ++i) crown.push_back(i);
    std::vector<CrownSource> sources(2);
    for (std::uint32_t s = 0; s < 2; ++s) {
      sources[s].trunk = {s};
      sources[s].reach_m = 20;
      sources[s].jump_m = 0;
    }
    const auto taken = splitCrown(all, crown, sources);
    const auto way_a = waysFrom(all, 0, 2), way_b = waysFrom(all, 1, 2);
    for (std::size_t i = 0; i < crown.size(); ++i) {
      const double a = way_a[crown[i]], b = way_b[crown[i]];
      const std::uint32_t nearest = std::isinf(std::min(a, b)) ? kNoSource : a < b ? 0U : 1U;
      EXPECT_EQ(taken[i], nearest) << "cluxel " << i << " has ways of " << a << " and " << b;
      all_reached += nearest != kNoSource ? 1 : 0;
    }
  }
  EXPECT_GT(all_reached, 1000);
}

/// The definition, vertex by vertex: the nearest open one is settled, and steps from it to all others are measured.
std::vector<std::uint32_t> splitByDefinition(const SceneCluxels& all, const std::vector<std::uint32_t>& crown,
                                             const std::vector<CrownSource>& sources) {
  using Way = std::pair<double, std::uint32_t>;
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<Way> best(crown.size(), {infinity, kNoSource});
  std::vector<bool> settled(crown.size(), false);
  const auto stepFrom = [&](std::uint32_t from, const Way& way, double jump_m) {
    const CrownSource& source = sources[way.second];
    const Eigen::Vector2d top = topOf(all, source.trunk);
    for (std::size_t to = 0; to < crown.size(); ++to) {
      const std::uint32_t cluxel = crown[to];
      const auto near = all.neighbours(from);
      const bool joined = std::find(near.begin(), near.end(), cluxel) != near.end();
      if (!joined && gapBetween(all, from, cluxel).gap() > jump_m) continue;
      if (static_cast<double>(all.height_above_ground[cluxel]) < source.clearance_m ||
          (all.center[cluxel].head<2>() - top).norm() > source.reach_m || !source.may_take(cluxel))
        continue;
      const double distance = (all.center[cluxel] - all.center[from]).norm();
      best[to] = std::min(best[to], Way{way.first + (joined ? 1 : 2) * distance, way.second});
    }
  };
  for (std::uint32_t s = 0; s < sources.size(); ++s)
    for (const std::uint32_t cluxel : sources[s].trunk)
      stepFrom(cluxel, {0, s}, std::max(sources[s].jump_m, sources[s].start_m));
  while (true) {
    std::size_t next = crown.size();
    for (std::size_t i = 0; i < crown.size(); ++i)
      if (!settled[i] && best[i].second != kNoSource && (next == crown.size() || best[i] < best[next])) next = i;
    if (next == crown.size()) break;
    settled[next] = true;
    stepFrom(crown[next], best[next], sources[best[next].second].jump_m);
  }
  std::vector<std::uint32_t> taken;
  for (const Way& way : best) taken.push_back(way.second);
  return taken;
}

TEST(CrownSplitting, IsTheDefinitionWithJumpsReachClearanceAndClaims) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0, 14), height(1.5, 5), jump(0.2, 0.8), reach(1.5, 5);
  std::size_t taken_by_several = 0, not_taken = 0;
  for (int round = 0; round < 30; ++round) {
    std::vector<Eigen::Vector3d> points;
    const std::uint32_t trunks = 1 + static_cast<std::uint32_t>(round) % 6;
    for (std::uint32_t s = 0; s < trunks; ++s) points.emplace_back(place(random), place(random), 2.2);
    for (int i = 0; i < 500; ++i) points.emplace_back(place(random), place(random), height(random));
    SceneCluxels all = cloudOf(points, 0.45);
    for (std::uint32_t i = trunks; i < all.size(); ++i) all.extent[i] *= static_cast<float>(1 + i % 4);
    std::vector<std::uint32_t> crown;
    for (std::uint32_t i = trunks; i < all.size(); ++i) crown.push_back(i);
    std::vector<CrownSource> sources(trunks);
    for (std::uint32_t s = 0; s < trunks; ++s) {
      sources[s] = {{s}, reach(random), jump(random), s % 2 == 0 ? 0.5 : 1.5, 1.8, {}};
      sources[s].may_take = [s, trunks](std::uint32_t cluxel) { return cluxel % 7 != s || trunks == 1; };
    }
    const auto expected = splitByDefinition(all, crown, sources);
    EXPECT_EQ(splitCrown(all, crown, sources), expected) << "round " << round;
    EXPECT_EQ(splitCrown(all, crown, sources, 2), expected) << "two threads, round " << round;
    const auto missed = static_cast<std::size_t>(std::count(expected.begin(), expected.end(), kNoSource));
    not_taken += missed;
    if (trunks > 1) taken_by_several += crown.size() - missed;
  }
  EXPECT_GT(taken_by_several, 500U);  // compilers draw the coordinates of a point in different order
  EXPECT_GT(not_taken, 2000U);
}

TEST(CrownSplitting, FollowsABranchThatReachesOverToTheNeighbour) {
  // A branch of the left tree ends nearer to the right trunk than to its own, without touching the right crown.
  std::vector<Eigen::Vector3d> points{{0, 0, 3}, {6, 0, 3}};
  for (int i = 1; i <= 9; ++i) points.emplace_back(0.5 * i, 0, 3.0 + 0.1 * i);
  points.emplace_back(6, 0.4, 3.3);
  const SceneCluxels all = cloudOf(points, 0.6);
  std::vector<std::uint32_t> crown;
  for (std::uint32_t i = 2; i < all.size(); ++i) crown.push_back(i);
  std::vector<CrownSource> sources(2);
  sources[0].trunk = {0};
  sources[1].trunk = {1};
  const auto taken = splitCrown(all, crown, sources);
  for (std::size_t i = 0; i + 1 < crown.size(); ++i) EXPECT_EQ(taken[i], 0U) << i;
  EXPECT_EQ(taken.back(), 1U);
}

TEST(CrownSplitting, BridgesGapsUpToTheJumpAndNotBeyond) {
  const SceneCluxels all = cloudOf({{0, 0, 2}, {0, 0, 2.4}, {0, 0, 2.9}, {0, 0, 4.5}}, 0.1);
  const std::vector<std::uint32_t> crown{1, 2, 3};
  std::vector<CrownSource> sources(1);
  sources[0].trunk = {0};
  sources[0].jump_m = 0.6;
  EXPECT_EQ(splitCrown(all, crown, sources), (std::vector<std::uint32_t>{0, 0, kNoSource}));
}

TEST(CrownSplitting, LeavesWhatIsTooFarTooLowOrNotClaimed) {
  const SceneCluxels all = cloudOf({{0, 0, 2}, {0.5, 0, 2}, {1, 0, 2}, {0.5, 0, 1.6}, {0, 0.5, 2}}, 0.7);
  const std::vector<std::uint32_t> crown{1, 2, 3, 4};
  std::vector<CrownSource> sources(1);
  sources[0].trunk = {0};
  sources[0].reach_m = 0.8;
  sources[0].clearance_m = 1.8;
  sources[0].may_take = [](std::uint32_t cluxel) { return cluxel != 4; };
  EXPECT_EQ(splitCrown(all, crown, sources), (std::vector<std::uint32_t>{0, kNoSource, kNoSource, kNoSource}));
}

}  // namespace
}  // namespace cluxel::testing
