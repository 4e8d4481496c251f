// SPDX-License-Identifier: Apache-2.0
// Which clusters of cluxels count as changed, by what the rays of few scans found.
#include "tasks/changes/changed_cluxels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace cluxel::tasks {
namespace {

std::uint64_t bits(std::size_t scans) {
  return (std::uint64_t{1} << scans) - 1;
}

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
  all.before.assign(all.cluxels.size(), {.hits = bits(9), .sparse_hits = bits(9)});
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
  for (RayFindings& after : all.after) after = {.passed = bits(scans)};
  return vanishedIn(all);
}

const RayFindings kDense{.hits = bits(9), .sparse_hits = bits(9)};
const RayFindings kHalfDense{.hits = bits(9), .sparse_hits = bits(5), .passed = bits(5)};

/// Several rays of later scans saw through the upper `rows` rows; the others are still hit.
std::size_t vanishedAbove(std::size_t rows, std::uint8_t scans) {
  constexpr std::size_t kColumns = 6;
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.after.size(); ++i) {
    if (i < all.after.size() - rows * kColumns)
      all.after[i] = {.hits = bits(9)};
    else
      all.after[i] = {.seen_through = bits(scans)};
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
  for (RayFindings& after : all.after) after = {.passed = bits(3)};
  EXPECT_EQ(possibleClusters(CluxelChange::Vanished, all).size(), 1U);
}

TEST(ChangedCluxels, FewRaysOfTwoScansShowThatALargeDenseThingIsGone) {
  EXPECT_EQ(vanishedAfter(2, kDense), 1);
  EXPECT_EQ(vanishedAfter(2, kHalfDense), 0);
}

TEST(ChangedCluxels, EachScanCountsHoweverManyThereAre) {
  ChangedCluxels all = thereBefore();
  all.before.assign(all.cluxels.size(), kHalfDense);
  for (RayFindings& after : all.after)
    for (const std::uint32_t scan : {20U, 84U, 148U}) after.passed.insert(scan);
  EXPECT_EQ(vanishedIn(all), 1);
}

TEST(ChangedCluxels, AThingThatWasAwayForAWhileIsNoCrown) {
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.cluxels.size(); ++i) {
    all.before[i].seen_through = bits(12) & ~bits(9);
    all.after[i] = {.seen_through = 1U << 12U};
  }
  EXPECT_EQ(vanishedIn(all), 1);
  for (std::size_t i = 0; i < all.cluxels.size(); ++i)  // each of these scans hits some of it
    all.before[i] = {.hits = i % 2 == 0 ? bits(12) : bits(9), .seen_through = i % 2 == 0 ? 0 : bits(12) & ~bits(9)};
  EXPECT_EQ(vanishedIn(all), 0);
}

TEST(ChangedCluxels, FewRaysOfTwoScansDoNotShowThatASmallThingIsGone) {
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.after.size(); ++i) {
    if (i < 18) all.before[i] = {};
    all.after[i] = {.passed = bits(2)};
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
    all.after[i] = i < 12 ? RayFindings{.hits = bits(9)} : RayFindings{.passed = bits(5)};
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

/// Several rays of five later scans passed each cluxel; at `aside` cluxels none of them would have ended at the thing.
ChangedCluxels passedAside(std::size_t aside) {
  ChangedCluxels all = thereBefore();
  for (std::size_t i = 0; i < all.after.size(); ++i) {
    all.after[i] = {.seen_through = bits(3), .passed = bits(5)};
    all.after[i].aside = all.after[i].seen_through.size() + all.after[i].passed.size() - (i < aside ? 0 : 1);
  }
  return all;
}

TEST(ChangedCluxels, RaysBesideAThingDoNotShowThatItIsGone) {
  EXPECT_EQ(vanishedIn(passedAside(30)), 0);
  EXPECT_EQ(vanishedIn(passedAside(23)), 0);
  EXPECT_EQ(vanishedIn(passedAside(22)), 1);
}

/// Three scans of each of three visits, of which those from `since` on are after.
Visits threeVisits(std::size_t since) {
  std::vector<double> times_s;
  for (const double visit : {0, 1, 2})
    for (const double scan : {0, 1, 2}) times_s.push_back(86400 * visit + 60 * scan);
  return Visits(times_s, 86400 * static_cast<double>(since));
}

ScanNumbers scansOfVisit(std::size_t visit) {
  return bits(3) << 3 * visit;
}

/// Two things of three columns each stood on visits of one kind, the left one on the first of them, the right one on
/// the second. The left one's first `hidden` rows were not observed on the second. The other visit saw neither.
std::vector<ChangeGroup> clustersOfTwoThings(CluxelChange kind, std::size_t hidden) {
  const bool has_vanished = kind == CluxelChange::Vanished;
  const std::size_t first = has_vanished ? 0 : 1, second = first + 1, without = has_vanished ? 2 : 0;
  ChangedCluxels all = thereBefore();
  all.visits = threeVisits(has_vanished ? 2 : 1);
  all.changes.assign(all.cluxels.size(), kind);
  for (std::size_t i = 0; i < all.cluxels.size(); ++i) {
    const bool is_left = i % 6 < 3;
    RayFindings with{.hits = scansOfVisit(is_left ? first : second),
                     .seen_through = scansOfVisit(is_left ? second : first)};
    if (is_left && i / 6 < hidden) with.seen_through = {};
    const RayFindings gone{.seen_through = scansOfVisit(without)};
    all.before[i] = has_vanished ? with : gone, all.after[i] = has_vanished ? gone : with;
  }
  return clustersOf(kind, all);
}

TEST(ChangedCluxels, AThingBesideThePlaceOfOneThatLeftBeforeIsToldAlone) {
  for (const CluxelChange kind : {CluxelChange::Vanished, CluxelChange::Appeared})
    for (const std::size_t hidden : {0U, 2U}) {
      const std::vector<ChangeGroup> clusters = clustersOfTwoThings(kind, hidden);
      const auto of_right = [](std::uint32_t cluxel) { return cluxel % 6 >= 3; };
      ASSERT_EQ(clusters.size(), 1U) << "with hidden rows: " << hidden;
      EXPECT_EQ(std::count_if(clusters[0].begin(), clusters[0].end(), of_right), 15);
      EXPECT_EQ(clusters[0].size(), 15U);
    }
}

}  // namespace
}  // namespace cluxel::tasks
