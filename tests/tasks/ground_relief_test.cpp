// SPDX-License-Identifier: Apache-2.0
// Which rises of the ground are slopes, and which are steps.
#include "tasks/ways/ground_relief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "tasks/ways/passable_grid.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {
namespace {

constexpr double kExtent_m = 12;

/// Observed ground of a square without things.
TerrainGrid groundOf(double cell_m, const std::function<double(const Eigen::Vector2d&)>& height_at) {
  TerrainGrid terrain;
  const int count = static_cast<int>(std::lround(kExtent_m / cell_m));
  terrain.frame = {0, 0, cell_m, count, count};
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    terrain.height.push_back(static_cast<float>(height_at(terrain.frame.centreOf(cell))));
  terrain.seen.assign(terrain.frame.size(), 1);
  terrain.first_thing.assign(terrain.frame.size() + 1, 0);
  return terrain;
}

double largestStep(const GroundRelief& relief) {
  return std::max(*std::max_element(relief.step_east.begin(), relief.step_east.end()),
                  *std::max_element(relief.step_north.begin(), relief.step_north.end()));
}

constexpr double kCells_m[] = {0.125, 0.25, 0.5, 1};

TEST(GroundRelief, AnEvenHillIsASlopeOfAnySteepnessWithoutSteps) {
  for (const double cell_m : kCells_m)
    for (const double slope : {0.02, 0.08, 0.14, 0.3, 1.0})
      for (const double angle : {0.0, 0.6, 1.57, 3.9}) {
        const Eigen::Vector2d up(slope * std::cos(angle), slope * std::sin(angle));
        const GroundRelief relief = reliefOf(groundOf(cell_m, [&](const Eigen::Vector2d& p) { return up.dot(p); }));
        for (const float measured : relief.slope) ASSERT_NEAR(measured, slope, 1e-3) << cell_m << " m cells";
        EXPECT_NEAR(largestStep(relief), 0, 1e-4) << slope << " at " << cell_m;
      }
}

TEST(GroundRelief, SlopesAreRightWhereHeightsAreUncertain) {
  std::mt19937 random(8);
  for (const double cell_m : {0.125, 0.25, 0.5})
    for (const double sigma_m : {0.005, 0.01})
      for (const double slope : {0.05, 0.1, 0.16, 0.3}) {
        std::normal_distribution<double> noise(0, sigma_m);
        const TerrainGrid terrain =
            groundOf(cell_m, [&](const Eigen::Vector2d& p) { return slope * p.y() + noise(random); });
        const GroundRelief relief = reliefOf(terrain);
        double sum = 0;
        std::size_t steps = 0;
        for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell) {
          sum += relief.slope[cell];
          steps += relief.step_north[cell] > 0.06F ? 1 : 0;
        }
        SCOPED_TRACE(testing::Message() << slope << " with " << sigma_m << " m, cells of " << cell_m << " m");
        const double mean = sum / static_cast<double>(terrain.frame.size());
        EXPECT_GT(mean, slope * 0.97);
        EXPECT_LT(mean, slope * 1.03 + sigma_m) << "noise across the slope adds to it";
        EXPECT_LT(static_cast<double>(steps), 0.004 * static_cast<double>(terrain.frame.size()));
      }
}

TEST(GroundRelief, AKerbIsAStepOfItsHeightAndNoSlope) {
  for (const double cell_m : kCells_m)
    for (const double kerb : {0.08, 0.15, 0.4})
      for (const double slope : {0.0, 0.05}) {
        const TerrainGrid terrain = groundOf(
            cell_m, [&](const Eigen::Vector2d& p) { return slope * p.y() + (p.x() < kExtent_m / 2 ? 0 : kerb); });
        const GroundRelief relief = reliefOf(terrain);
        const int last = terrain.frame.columns / 2 - 1;  // before the kerb
        for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell) {
          ASSERT_NEAR(relief.slope[cell], slope, 1e-3) << kerb << " at " << cell_m;
          ASSERT_NEAR(relief.step_east[cell], terrain.frame.columnOf(cell) == last ? kerb : 0, 1e-4) << cell_m;
        }
      }
}

TEST(GroundRelief, NoWayLeadsOverAKerbThatIsTooHigh) {
  const auto expectClosed = [](const TerrainGrid& terrain, double kerb) {
    EXPECT_TRUE(findRoutes(passableOf(terrain, {}, {}, {}), {1, 2}, {11, 2}, 1).routes.empty());
    WayParams climbing;
    climbing.max_step_m = 0.2;
    const RouteAnswer over = findRoutes(passableOf(terrain, climbing, {}, {}), {1, 2}, {11, 2}, 1);
    ASSERT_EQ(over.routes.size(), 1U);
    EXPECT_NEAR(over.routes[0].highest_step_m, kerb, 0.03);
  };
  for (const double cell_m : {0.125, 0.25, 0.5})
    for (const double kerb : {0.08, 0.12}) {
      for (const double lean : {0.0, 0.07, 0.3, 0.9}) {
        SCOPED_TRACE(testing::Message() << kerb << " m aslant by " << lean << ", cells of " << cell_m << " m");
        expectClosed(groundOf(cell_m, [&](const Eigen::Vector2d& p) { return p.x() < 4.1 + lean * p.y() ? 0 : kerb; }),
                     kerb);
      }
      if (cell_m > 0.25) continue;
      SCOPED_TRACE(testing::Message() << kerb << " m over 0.2 m, cells of " << cell_m << " m");
      expectClosed(
          groundOf(cell_m, [&](const Eigen::Vector2d& p) { return kerb * std::clamp((p.x() - 4.1) / 0.2, 0.0, 1.0); }),
          kerb);
    }
}

TEST(GroundRelief, ARampOfAMetreIsTooSteepNotAStep) {
  const TerrainGrid terrain =
      groundOf(0.25, [](const Eigen::Vector2d& p) { return 0.2 * std::clamp(p.x() - 5.125, 0.0, 1.0); });
  const GroundRelief relief = reliefOf(terrain);
  EXPECT_NEAR(*std::max_element(relief.slope.begin(), relief.slope.end()), 0.2, 1e-3);
  EXPECT_LT(largestStep(relief), 0.06);
}

TEST(GroundRelief, LargerLimitsOnlyOpenWays) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.006);
  std::uniform_real_distribution<double> share(0, 1);
  for (int round = 0; round < 12; ++round) {
    const double cell_m = kCells_m[round % 3], tilt = 0.3 * share(random), kerb = 0.2 * share(random);
    const TerrainGrid terrain = groundOf(cell_m, [&](const Eigen::Vector2d& p) {
      return tilt * p.y() * p.y() / kExtent_m + (std::sin(p.x()) > 0.3 ? kerb : 0) + noise(random);
    });
    std::size_t before = 0;
    for (const double max_step_m : {0.01, 0.03, 0.06, 0.1, 0.2, 0.5}) {
      WayParams params;
      params.max_step_m = max_step_m;
      params.max_slope = 2;
      const LargeArray<double> walk_m = walkLengths(passableOf(terrain, params, {}, {}), {6, 1}, 1e9);
      const auto reached = static_cast<std::size_t>(
          std::count_if(walk_m.begin(), walk_m.end(), [](double length) { return std::isfinite(length); }));
      EXPECT_GE(reached, before) << "with steps of " << max_step_m;
      before = reached;
    }
    EXPECT_EQ(before, terrain.frame.size());
  }
}

TEST(GroundRelief, TellsNothingWhereGroundWasNotObserved) {
  TerrainGrid terrain = groundOf(0.25, [](const Eigen::Vector2d& p) { return p.x() < 6 ? 0.0 : 1.0; });
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    if (terrain.frame.columnOf(cell) >= terrain.frame.columns / 2) terrain.seen[cell] = 0;
  const GroundRelief relief = reliefOf(terrain);
  EXPECT_EQ(largestStep(relief), 0);
  EXPECT_EQ(*std::max_element(relief.slope.begin(), relief.slope.end()), 0);
}

}  // namespace
}  // namespace cluxel::tasks
