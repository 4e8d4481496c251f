// SPDX-License-Identifier: Apache-2.0
// Which clusters of cluxels count as changed, by what the rays of few scans found.
#include "tasks/changes/changed_cluxels.hpp"

#include <gtest/gtest.h>

namespace cluxel::tasks {
namespace {

/// A board of 6 by 5 cluxels that lies flat, 0.3 m apart; neighbours intersect.
perception::SceneCluxels board() {
  constexpr std::uint32_t kColumns = 6, kRows = 5;
  perception::SceneCluxels cluxels;
  cluxels.edge_offset.push_back(0);
  for (std::uint32_t row = 0; row < kRows; ++row)
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      cluxels.name.emplace_back();
      cluxels.low_corner.emplace_back(0.3 * column, 0.3 * row, 1);
      cluxels.extent.emplace_back(0.3F, 0.3F, 0.3F);
      cluxels.center.emplace_back(0.3 * column + 0.15, 0.3 * row + 0.15, 1.15);
      const std::uint32_t number = row * kColumns + column;
      if (row > 0) cluxels.edge_target.push_back(number - kColumns);
      if (column > 0) cluxels.edge_target.push_back(number - 1);
      if (column + 1 < kColumns) cluxels.edge_target.push_back(number + 1);
      if (row + 1 < kRows) cluxels.edge_target.push_back(number + kColumns);
      cluxels.edge_offset.push_back(static_cast<std::uint32_t>(cluxels.edge_target.size()));
    }
  return cluxels;
}

/// Scans that hit each cluxel before.
ChangedCluxels thereBefore() {
  ChangedCluxels all;
  all.cluxels = board();
  all.is_told.assign(all.cluxels.size(), true);
  all.before.assign(all.cluxels.size(), {.is_hit = true, .hits = 9, .sparse_hits = 9});
  all.after.resize(all.cluxels.size());
  return all;
}

std::size_t vanishedIn(ChangedCluxels all) {
  all.changes.clear();
  for (std::uint32_t i = 0; i < all.cluxels.size(); ++i) all.changes.push_back(changeOf(all.before[i], all.after[i]));
  const std::vector<ChangeGroup> clusters = clustersOf(CluxelChange::Vanished, all);
  ChangedCluxels without_own = all;
  without_own.before.assign(all.before.size(), {});
  const std::vector<ChangeGroup> possible = possibleClusters(CluxelChange::Vanished, without_own);
  EXPECT_EQ(clustersAmong(possible, CluxelChange::Vanished, all), clusters) << "possible ones hold all that are sure";
  return clusters.size();
}

/// Few rays of later scans passed each cluxel; `before` was found while they were there.
std::size_t vanishedAfter(std::uint8_t scans, const RayFindings& before) {
  ChangedCluxels all = thereBefore();
  all.before.assign(all.cluxels.size(), before);
  for (RayFindings& after : all.after) after = {.passed = scans, .passed_scans = (std::uint64_t{1} << scans) - 1};
  return vanishedIn(all);
}

constexpr RayFindings kDense{.is_hit = true, .hits = 9, .sparse_hits = 9};
constexpr RayFindings kHalfDense{.is_hit = true, .hits = 9, .sparse_hits = 5, .passed = 5};

/// Several rays of later scans saw through the upper `rows` rows; the others are still hit.
std::size_t vanishedAbove(std::size_t rows, std::uint8_t scans) {
  constexpr std::size_t kColumns = 6;
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.after.size(); ++i) {
    if (i < all.after.size() - rows * kColumns)
      all.after[i] = {.is_hit = true, .hits = 9};
    else
      all.after[i] = {.is_seen_through = true, .seen_through = scans, .through_scans = (std::uint64_t{1} << scans) - 1};
  }
  return vanishedIn(all);
}

TEST(ChangedCluxels, AThingThatNoLaterRayPassesIsNotGone) {
  EXPECT_EQ(vanishedAfter(0, kDense), 0);
}

TEST(ChangedCluxels, FewRaysOfOneScanDoNotShowThatAThingIsGone) {
  EXPECT_EQ(vanishedAfter(1, kDense), 0);
}

TEST(ChangedCluxels, WhatNoLaterRaySawThroughIsNoPossibleCluster) {
  ChangedCluxels all = thereBefore();
  all.changes.assign(all.cluxels.size(), CluxelChange::Vanished);
  EXPECT_TRUE(possibleClusters(CluxelChange::Vanished, all).empty());
  for (RayFindings& after : all.after) after = {.passed = 3, .passed_scans = 7};
  EXPECT_EQ(possibleClusters(CluxelChange::Vanished, all).size(), 1U);
}

TEST(ChangedCluxels, FewRaysOfTwoScansShowThatALargeDenseThingIsGone) {
  EXPECT_EQ(vanishedAfter(2, kDense), 1);
  EXPECT_EQ(vanishedAfter(2, kHalfDense), 0);
}

TEST(ChangedCluxels, FewRaysOfTwoScansDoNotShowThatASmallThingIsGone) {
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.after.size(); ++i) {
    if (i < 18) all.before[i] = {};
    all.after[i] = {.passed = 2, .passed_scans = 3};
  }
  EXPECT_EQ(vanishedIn(all), 1) << "12 cluxels";
  all.before[18] = {};
  EXPECT_EQ(vanishedIn(all), 0) << "11 cluxels";
}

TEST(ChangedCluxels, FewRaysOfEachOfThreeScansShowThatAThingIsGone) {
  EXPECT_EQ(vanishedAfter(3, kDense), 1);
  EXPECT_EQ(vanishedAfter(3, kHalfDense), 1);
}

TEST(ChangedCluxels, SeveralRaysOfOneScanShowThatAWholeThingIsGone) {
  EXPECT_EQ(vanishedAbove(5, 1), 1);
}

TEST(ChangedCluxels, ThreeScansMustAgreeThatAPartOfWhatStaysIsGone) {
  EXPECT_EQ(vanishedAbove(3, 1), 0);
  EXPECT_EQ(vanishedAbove(3, 2), 0);
  EXPECT_EQ(vanishedAbove(3, 3), 1);
}

/// Few rays of five later scans passed all but two rows; these are still hit.
ChangedCluxels partlyPassed() {
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.after.size(); ++i)
    all.after[i] = i < 12 ? RayFindings{.is_hit = true, .hits = 9} : RayFindings{.passed = 5, .passed_scans = 31};
  return all;
}

TEST(ChangedCluxels, FewRaysDoNotShowThatAPartOfWhatStaysIsGone) {
  EXPECT_EQ(vanishedIn(partlyPassed()), 0);
}

TEST(ChangedCluxels, FewRaysOfSeveralScansShowThatAllIsGoneAboveWhatStays) {
  ChangedCluxels all = partlyPassed();
  for (Eigen::Vector3d& center : all.cluxels.center) std::swap(center.y(), center.z());
  EXPECT_EQ(vanishedIn(all), 1);
  for (Eigen::Vector3d& center : all.cluxels.center) center.z() *= -1;
  EXPECT_EQ(vanishedIn(all), 0) << "what stays lies above";
}

}  // namespace
}  // namespace cluxel::tasks
