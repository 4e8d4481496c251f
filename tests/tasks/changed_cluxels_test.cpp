// SPDX-License-Identifier: Apache-2.0
// Which clusters of cluxels count as changed, by what the rays of few scans found.
#include "tasks/changes/changed_cluxels.hpp"

#include <gtest/gtest.h>

namespace cluxel::tasks {
namespace {

/// A board of 6 by 5 cluxels, 0.3 m apart; neighbours intersect.
perception::SceneCluxels board() {
  constexpr std::uint32_t kColumns = 6, kRows = 5;
  perception::SceneCluxels cluxels;
  cluxels.edge_offset.push_back(0);
  for (std::uint32_t row = 0; row < kRows; ++row)
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      cluxels.name.emplace_back();
      cluxels.low_corner.emplace_back(0.3 * column, 0.3 * row, 1);
      cluxels.extent.emplace_back(0.3F, 0.3F, 0.3F);
      const std::uint32_t number = row * kColumns + column;
      if (row > 0) cluxels.edge_target.push_back(number - kColumns);
      if (column > 0) cluxels.edge_target.push_back(number - 1);
      if (column + 1 < kColumns) cluxels.edge_target.push_back(number + 1);
      if (row + 1 < kRows) cluxels.edge_target.push_back(number + kColumns);
      cluxels.edge_offset.push_back(static_cast<std::uint32_t>(cluxels.edge_target.size()));
    }
  return cluxels;
}

/// Scans hit each cluxel before, and few rays of later ones passed each.
std::size_t vanishedAfter(std::uint8_t scans) {
  ChangedCluxels all;
  all.cluxels = board();
  for (std::uint32_t i = 0; i < all.cluxels.size(); ++i) {
    all.is_told.push_back(true);
    all.before.push_back({.is_hit = true, .hits = 9, .sparse_hits = 9});
    all.after.push_back({.passed = scans, .passed_scans = (std::uint64_t{1} << scans) - 1});
    all.changes.push_back(changeOf(all.before.back(), all.after.back()));
  }
  return clustersOf(CluxelChange::Vanished, all).size();
}

TEST(ChangedCluxels, AThingThatNoLaterRayPassesIsNotGone) {
  EXPECT_EQ(vanishedAfter(0), 0);
}

TEST(ChangedCluxels, FewRaysOfOneOrTwoScansDoNotShowThatAThingIsGone) {
  EXPECT_EQ(vanishedAfter(1), 0);
  EXPECT_EQ(vanishedAfter(2), 0);
}

TEST(ChangedCluxels, FewRaysOfEachOfThreeScansShowThatAThingIsGone) {
  EXPECT_EQ(vanishedAfter(3), 1);
}

}  // namespace
}  // namespace cluxel::tasks
