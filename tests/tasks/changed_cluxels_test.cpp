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

/// Scans that hit each cluxel before, and later ones of which few rays passed each.
CluxelFindings passedBy(std::uint8_t scans, const perception::SceneCluxels& cluxels) {
  CluxelFindings findings;
  for (std::uint32_t i = 0; i < cluxels.size(); ++i) {
    findings.numbers.push_back(i);
    findings.before.push_back({.is_hit = true, .hits = 9, .sparse_hits = 9});
    findings.after.push_back({.passed = scans, .passed_scans = (std::uint64_t{1} << scans) - 1});
  }
  return findings;
}

std::size_t vanishedAfter(std::uint8_t scans) {
  const perception::SceneCluxels cluxels = board();
  const CluxelFindings findings = passedBy(scans, cluxels);
  return clustersOf(CluxelChange::Vanished, changesOf(findings, cluxels.size()), findings, cluxels).size();
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
