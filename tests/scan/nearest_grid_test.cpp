// SPDX-License-Identifier: Apache-2.0
// Compares the grid with a linear search.
#include "scan/registration/nearest_grid.hpp"

#include <gtest/gtest.h>

#include <random>

namespace cluxel::scan {
namespace {

std::vector<Eigen::Vector3f> randomPoints(std::mt19937& bits, std::size_t count, float spread_m) {
  std::vector<Eigen::Vector3f> points;
  const auto share = [&] { return static_cast<float>(bits() % 4096) / 4096.0F - 0.5F; };
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(spread_m * share(), spread_m * share(), 0.2F * spread_m * share());
  return points;
}

std::optional<std::size_t> tryingAll(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& p,
                                     double reach_m) {
  std::optional<std::size_t> best;
  double best_m2 = reach_m * reach_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double m2 = (points[i].cast<double>() - p).squaredNorm();
    if (best ? m2 < best_m2 : m2 <= best_m2) {
      best = i;
      best_m2 = m2;
    }
  }
  return best;
}

TEST(NearestGrid, FindsWhatTryingAllPointsFinds) {
  std::mt19937 bits(5);
  for (const float spread_m : {0.4F, 8.0F, 30.0F}) {
    const auto points = randomPoints(bits, 3000, spread_m);
    const NearestGrid grid(points, 0.5);
    std::size_t found = 0;
    for (const Eigen::Vector3f& query : randomPoints(bits, 800, 1.3F * spread_m)) {
      for (const double reach_m : {0.5, 0.2}) {
        const auto expected = tryingAll(points, query.cast<double>(), reach_m);
        EXPECT_EQ(grid.nearest(query.cast<double>(), reach_m), expected);
        found += expected.has_value() ? 1 : 0;
      }
    }
    EXPECT_GT(found, 50U);
  }
}

TEST(NearestGrid, OfEquallyNearPointsTheFirstIsTaken) {
  const NearestGrid grid({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {1, 0, 0}}, 2);
  EXPECT_EQ(grid.nearest({0, 0, 0}, 2), 0U);
}

TEST(NearestGrid, HoldsFarApartPointsAndNone) {
  const NearestGrid far({{-90000, 0, 0}, {90000, 70000, 5}}, 0.5);
  EXPECT_EQ(far.nearest({90000.2, 70000, 5}, 0.5), 1U);
  EXPECT_EQ(far.nearest({0, 0, 0}, 0.5), std::nullopt);
  EXPECT_EQ(NearestGrid({}, 0.5).nearest({0, 0, 0}, 0.5), std::nullopt);
}

}  // namespace
}  // namespace cluxel::scan
