// SPDX-License-Identifier: Apache-2.0
// Trees that touch, against a comparison of every two points.
#include "tasks/evaluation/touching_trees.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cluxel::tasks {
namespace {

struct TreePoint {
  Eigen::Vector3d p_map;
  std::int32_t tree = 0;
};

std::set<std::array<std::int32_t, 2>> pairsByForce(const std::vector<TreePoint>& points) {
  std::vector<Eigen::Vector3d> cells;
  for (const TreePoint& point : points) cells.emplace_back((point.p_map / 0.25).array().floor());
  std::set<std::array<std::int32_t, 2>> pairs;
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = 0; b < points.size(); ++b)
      if (points[a].tree < points[b].tree && (cells[a] - cells[b]).cwiseAbs().maxCoeff() <= 1)
        pairs.insert({points[a].tree, points[b].tree});
  return pairs;
}

TEST(TouchingTrees, AreThosePairsThatAComparisonOfAllPointsFinds) {
  std::mt19937 random(5);
  std::normal_distribution<double> spread(0, 0.4);
  std::uniform_real_distribution<double> place(-4, 4);
  for (int round = 0; round < 8; ++round) {
    std::vector<TreePoint> points;
    for (std::int32_t tree = 0; tree < 12; ++tree) {
      const Eigen::Vector3d crown(place(random), place(random), 0.2 * place(random));
      for (int i = 0; i < 40; ++i)
        points.push_back({crown + Eigen::Vector3d(spread(random), spread(random), spread(random)), tree});
    }
    std::shuffle(points.begin(), points.end(), random);
    const auto expected = pairsByForce(points);
    EXPECT_GT(expected.size(), 2U);
    EXPECT_LT(expected.size(), 66U) << "all touch";
    for (const std::size_t bytes : {std::size_t{1}, std::size_t{4000}, SortedRecords::kUsualBytes}) {
      TouchingTrees trees(bytes);
      for (const TreePoint& point : points) trees.add(point.p_map, point.tree);
      EXPECT_EQ(trees.takePairs(), expected);
      EXPECT_TRUE(trees.takePairs().empty()) << "all points are forgotten";
    }
  }
}

}  // namespace
}  // namespace cluxel::tasks
