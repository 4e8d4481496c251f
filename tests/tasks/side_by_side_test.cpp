// SPDX-License-Identifier: Apache-2.0
// What falls apart into things that stood side by side, and what does not.
#include "tasks/changes/side_by_side.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace cluxel::tasks {
namespace {

constexpr bool kStructure = false, kFoliage = true;

void addSheet(std::vector<PointCell>& cells, double at_m, double from_m, double to_m, bool is_foliage) {
  // Askew to the axes of the map.
  const Eigen::Vector3d along(0.8, 0.6, 0), across(-0.6, 0.8, 0);
  for (double s = from_m; s <= to_m; s += 0.1)
    for (double z = 0; z <= 1; z += 0.1)
      cells.push_back({.place = at_m * across + s * along + z * Eigen::Vector3d::UnitZ(), .is_foliage = is_foliage});
}

std::vector<std::size_t> sizesAfterSplit(const std::vector<PointCell>& cells) {
  ChangeGroup all(cells.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<std::size_t> sizes;
  for (const ChangeGroup& part : sheetsOf(cells, all)) sizes.push_back(part.size());
  return sizes;
}

TEST(SideBySide, BicyclesInARackAreToldApart) {
  std::vector<PointCell> cells;
  for (int i = 0; i < 3; ++i) addSheet(cells, 0.55 * i, 0, 1.7, kStructure);
  const std::size_t each = cells.size() / 3;
  EXPECT_EQ(sizesAfterSplit(cells), std::vector<std::size_t>(3, each));
}

TEST(SideBySide, TheWheelsOfABicycleStayTogether) {
  std::vector<PointCell> cells;
  addSheet(cells, 0, 0, 0.65, kStructure);
  addSheet(cells, 0, 1.05, 1.7, kStructure);
  EXPECT_EQ(sizesAfterSplit(cells).size(), 1U);
}

TEST(SideBySide, TheSidesOfACarStayTogether) {
  std::vector<PointCell> cells;
  addSheet(cells, 0, 0, 4, kStructure);
  addSheet(cells, 1.8, 0, 4, kStructure);
  for (double at_m = 0.1; at_m < 1.75; at_m += 0.1) {
    addSheet(cells, at_m, 0, 0.05, kStructure);
    addSheet(cells, at_m, 3.95, 4, kStructure);
  }
  EXPECT_EQ(sizesAfterSplit(cells).size(), 1U);
}

TEST(SideBySide, TheSidesOfAHedgeStayTogether) {
  std::vector<PointCell> cells;
  for (const double at_m : {0.0, 0.8}) addSheet(cells, at_m, 0, 3, kFoliage);
  EXPECT_EQ(sizesAfterSplit(cells).size(), 1U);
}

}  // namespace
}  // namespace cluxel::tasks
