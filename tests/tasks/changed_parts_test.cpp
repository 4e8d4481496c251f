// SPDX-License-Identifier: Apache-2.0
// Which groups of cells count as changed, by what the rays of both times found at them.
#include "tasks/changes/changed_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cluxel::tasks {
namespace {

constexpr std::uint64_t bits(int scans) {
  return (std::uint64_t{1} << scans) - 1;
}

constexpr bool kStructure = false, kFoliage = true;

/// A disc of cells around a pole that stays.
std::vector<PointCell> lampHead(bool is_foliage, int passing_scans) {
  std::vector<PointCell> cells;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y) {
      PointCell cell{.place = {0.1 * x, 0.1 * y, 4}, .is_foliage = is_foliage, .scans = bits(5)};
      if (x == 0 && y == 0) cell.is_shared = true;
      cell.own = {.hit_scans = bits(5), .rays = {.ended = 10, .passed = 1}};
      cell.other = {.through_scans = bits(passing_scans), .rays = {.passed = 10}};
      cells.push_back(cell);
    }
  return cells;
}

/// With things beside it, at its height, that are there at both times.
std::vector<PointCell> besideWhatStays(std::vector<PointCell> cells) {
  for (int i = -4; i <= 4; ++i)
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(0.1 * i, -0.4, 4), {0.1 * i, 0.4, 4}, {-0.4, 0.1 * i, 4}, {0.4, 0.1 * i, 4}})
      cells.push_back({.place = place, .is_shared = true});
  return cells;
}

std::size_t partsIn(const std::vector<PointCell>& cells) {
  return changedParts(cells).size();
}

TEST(ChangedParts, AHeadAroundAPoleThatStaysIsFound) {
  const auto parts = changedParts(lampHead(kStructure, 5));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts.front().size(), 48U);
}

TEST(ChangedParts, NothingFollowsWhereNoRayOfTheOtherTimePassed) {
  EXPECT_EQ(partsIn(lampHead(kStructure, 0)), 0U);
}

TEST(ChangedParts, TwoScansThatPassedShowThatALargeThingIsGone) {
  const std::vector<PointCell> large = lampHead(kStructure, 2);
  EXPECT_EQ(partsIn(large), 1U);
  EXPECT_EQ(partsIn(lampHead(kStructure, 1)), 0U);
  EXPECT_EQ(partsIn(besideWhatStays(large)), 0U) << "a part of something";
  std::vector<PointCell> half = large, some_hit = large;
  std::erase_if(half, [](const PointCell& cell) { return cell.place.x() < -0.05; });
  EXPECT_EQ(partsIn(half), 0U) << "a small one";
  for (std::size_t i = 0; i < some_hit.size(); i += 8)
    some_hit[i].other.hit_scans = bits(1), some_hit[i].other.through_scans = bits(2) & ~bits(1);
  EXPECT_EQ(partsIn(some_hit), 0U) << "something is left";
}

TEST(ChangedParts, FewLooksOfTwoScansDoNotShowThatALargeThingIsGone) {
  // One scan looks at each cell, and rays of the own time pass, too: log-odds of 45 and of 58, where 50 are needed.
  const auto seenByFew = [](int own_scans) {
    std::vector<PointCell> cells = lampHead(kStructure, 0);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i].own.through_scans = bits(own_scans) & ~bits(5);
      cells[i].other.through_scans.insert(static_cast<std::uint32_t>(i % 2));
    }
    return cells;
  };
  EXPECT_EQ(partsIn(seenByFew(8)), 0U);
  EXPECT_EQ(partsIn(seenByFew(7)), 1U);
}

TEST(ChangedParts, AScanWithAPoorPoseDoesNotKeepAPartThatIsGone) {
  std::vector<PointCell> cells = lampHead(kStructure, 5);
  for (PointCell& cell : cells)
    if (cell.place.x() > 0.15) cell.other.hit_scans = bits(1), cell.other.through_scans = bits(5) & ~bits(1);
  EXPECT_EQ(partsIn(cells), 1U);
}

TEST(ChangedParts, APartThatHalfOfTheScansStillHitIsThere) {
  std::vector<PointCell> cells = lampHead(kStructure, 6);
  for (PointCell& cell : cells) cell.other.hit_scans = bits(3), cell.other.through_scans = bits(6) & ~bits(3);
  EXPECT_EQ(partsIn(cells), 0U);
}

TEST(ChangedParts, PossibleOnesHoldAllThatAreSure) {
  std::size_t sure = 0;
  for (const bool is_foliage : {kStructure, kFoliage})
    for (int passing = 0; passing < 8; ++passing)
      for (const std::uint32_t ended : {1U, 3U, 10U})
        for (const bool is_beside : {false, true}) {
          std::vector<PointCell> cells = lampHead(is_foliage, passing);
          for (PointCell& cell : cells) cell.own.rays = {.ended = ended, .passed = 1};
          if (is_beside) cells = besideWhatStays(std::move(cells));
          const std::vector<ChangeGroup> parts = changedParts(cells);
          EXPECT_EQ(partsAmong(possibleParts(cells), cells), parts);
          sure += parts.size();
        }
  EXPECT_GT(sure, 0U);
}

TEST(ChangedParts, AGapInACrownIsNotGone) {
  // Some scans of the other time hit leaves in the gap, and some rays of its own time pass, too.
  const auto crown = [](bool is_foliage) {
    std::vector<PointCell> cells = lampHead(is_foliage, 8);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i].own.through_scans = bits(8) & ~bits(5);
      if (i % 3 == 0) cells[i].other.hit_scans = bits(1), cells[i].other.through_scans = bits(8) & ~bits(1);
    }
    return besideWhatStays(cells);
  };
  EXPECT_EQ(partsIn(crown(kFoliage)), 0U);
  EXPECT_EQ(partsIn(crown(kStructure)), 1U);
}

TEST(ChangedParts, FoliageOfWhichNothingIsLeftAtItsHeightIsGone) {
  // A scan of the other time with a poor pose hits what stays below.
  std::vector<PointCell> top = lampHead(kFoliage, 5);
  for (std::size_t i = 0; i < top.size(); ++i) {
    top[i].scans = bits(3);
    if (i % 3 == 0) top[i].other.hit_scans = bits(1);
  }
  EXPECT_EQ(partsIn(top), 1U);
  EXPECT_EQ(partsIn(besideWhatStays(top)), 0U);
  for (PointCell& cell : top) cell.scans = bits(2);
  EXPECT_EQ(partsIn(top), 0U) << "two scans measured it";
}

TEST(ChangedParts, WeakEvidenceDoesNotShowThatAPartBesideWhatStaysIsGone) {
  std::vector<PointCell> plate = lampHead(kStructure, 4);
  std::erase_if(plate, [](const PointCell& cell) {
    return cell.is_shared || std::abs(cell.place.y()) > 0.15 || cell.place.x() < -0.15;
  });
  for (PointCell& cell : plate) cell.own.through_scans = bits(8) & ~bits(5);
  EXPECT_EQ(partsIn(plate), 1U);
  const auto besideOne = [&](std::vector<PointCell> cells) {
    for (int i = -1; i <= 1; ++i) cells.push_back({.place = {0.5, 0.1 * i, 4}, .is_shared = true});
    return cells;
  };
  EXPECT_EQ(partsIn(besideOne(plate)), 0U);
  for (PointCell& cell : plate) cell.own.through_scans = 0;
  EXPECT_EQ(partsIn(besideOne(plate)), 1U) << "strong evidence does";
}

TEST(ChangedParts, RaysMayPassBesideTheEdgeOfAHeadWhenTheEvidenceIsStrong) {
  std::vector<PointCell> head = lampHead(kStructure, 6);
  for (std::size_t i = 0; i < head.size(); ++i) {
    head[i].own = {.hit_scans = bits(5), .through_scans = bits(8) & ~bits(5), .rays = {.ended = 10, .passed = 7}};
    if (i % 3 == 0) head[i].other.hit_scans = bits(1);
  }
  const auto besideRow = [&](std::vector<PointCell> cells) {
    for (int i = -3; i <= 3; ++i) cells.push_back({.place = {0.4, 0.1 * i, 4}, .is_shared = true});
    return cells;
  };
  EXPECT_EQ(partsIn(besideRow(head)), 1U);
  EXPECT_EQ(partsIn(besideWhatStays(head)), 0U) << "much stays beside it";
}

TEST(ChangedParts, APartInACrownIsGoneWhenTheLooksAtEachOfItsCellsAreClear) {
  std::vector<PointCell> half = lampHead(kFoliage, 4);
  std::erase_if(half, [](const PointCell& cell) { return cell.is_shared || cell.place.x() < 0.05; });
  EXPECT_EQ(partsIn(besideWhatStays(half)), 1U);
  std::vector<PointCell> gap = half, touched = half;
  for (PointCell& cell : gap) cell.own.through_scans = bits(8) & ~bits(5);
  EXPECT_EQ(partsIn(besideWhatStays(gap)), 0U) << "scans of its own time pass, too";
  for (std::size_t i = 0; i < touched.size(); i += 2) touched[i].other.hit_scans = bits(1);
  EXPECT_EQ(partsIn(besideWhatStays(touched)), 0U) << "leaves are left";
}

/// A wall of 20 by 20 cells that goes on to the side. Each of its cells is passed by one of four scans, or by more.
std::vector<PointCell> wall(int scans_of_cell) {
  std::vector<PointCell> cells;
  for (int x = 0; x < 27; ++x)
    for (int z = 0; z < 20; ++z) {
      PointCell cell{.place = {0.1 * x, 0, 0.1 * z}, .is_shared = x >= 20, .scans = bits(5)};
      cell.own = {.hit_scans = bits(5), .through_scans = bits(6) & ~bits(5), .rays = {.ended = 9, .passed = 1}};
      for (int i = 0; i < scans_of_cell; ++i)
        cell.other.through_scans.insert(static_cast<std::uint32_t>(x / 5 + i) % 4);
      cells.push_back(cell);
    }
  return cells;
}

TEST(ChangedParts, AScanThatPassesOnePartOfAWallDoesNotTellOfAnother) {
  EXPECT_EQ(partsIn(wall(1)), 0U);
  EXPECT_EQ(partsIn(wall(2)), 1U);
}

TEST(ChangedParts, FewLooksAtLeavesDoNotShowThatAllOfThemAreGone) {
  const auto leaves = [](int scans_of_cell) {
    std::vector<PointCell> cells = lampHead(kFoliage, 0);
    std::erase_if(cells, [](const PointCell& cell) { return cell.is_shared || cell.place.x() < 0.05; });
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i].own.through_scans = bits(8) & ~bits(5);
      for (int scan = 0; scan < scans_of_cell; ++scan)
        cells[i].other.through_scans.insert(static_cast<std::uint32_t>(i + static_cast<std::size_t>(scan)) % 3);
    }
    return cells;
  };
  EXPECT_EQ(partsIn(leaves(1)), 0U);
  EXPECT_EQ(partsIn(leaves(3)), 1U);
}

/// Copies of a group side by side.
std::vector<PointCell> wider(const std::vector<PointCell>& cells, int copies) {
  std::vector<PointCell> all;
  for (int copy = 0; copy < copies; ++copy)
    for (PointCell cell : cells) {
      cell.place.x() += 0.7 * copy;
      all.push_back(cell);
    }
  return all;
}

TEST(ChangedParts, MuchOfAThingThatRaysPartlyPassIsGoneWhenManyLooksMissIt) {
  // Rays of its own time pass, and now and then one of the other time ends there. Four in five of its own looks hit.
  std::vector<PointCell> cells = lampHead(kFoliage, 8);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].own = {.hit_scans = bits(4), .through_scans = bits(5), .rays = {.ended = 10, .passed = 10}};
    if (i % 3 == 0) cells[i].other.hit_scans = bits(1);
  }
  EXPECT_EQ(partsIn(wider(cells, 3)), 1U);
  for (PointCell& cell : cells) cell.other.through_scans = bits(2);
  EXPECT_EQ(partsIn(wider(cells, 3)), 0U) << "two scans are too few";
}

TEST(ChangedParts, APartThatItsOwnScansMostlyMissTellsNothing) {
  std::vector<PointCell> cells = lampHead(kStructure, 8);
  for (PointCell& cell : cells) cell.own.through_scans = bits(12) & ~bits(5);
  EXPECT_EQ(partsIn(cells), 0U);
}

}  // namespace
}  // namespace cluxel::tasks
