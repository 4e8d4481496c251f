// SPDX-License-Identifier: Apache-2.0
// Which changes are told of a thing of which rays tell on several visits.
#include "tasks/changes/changed_things.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace cluxel::tasks {
namespace {

using perception::PresenceState;

constexpr std::uint32_t kCluxels = 8, kScansOfVisit = 4;

/// Eight cluxels of object 0, one above the other, on four visits of four scans. The last visit comes after.
struct Column {
  std::array<bool, 4> is_there{};                ///< on each visit
  PresenceState after = PresenceState::Present;  ///< of the object, which was there before
};

ScanNumbers scansOnVisit(std::uint32_t visit) {
  ScanNumbers scans;
  for (std::uint32_t scan = 0; scan < kScansOfVisit; ++scan) scans.insert(visit * kScansOfVisit + scan);
  return scans;
}

ChangeSurvey surveyOfColumn(const Column& column) {
  constexpr double kDay_s = 86400;
  std::vector<double> times_s;
  for (std::uint32_t scan = 0; scan < 4 * kScansOfVisit; ++scan)
    times_s.push_back(kDay_s * (scan / kScansOfVisit) + scan);
  ChangeSurvey survey;
  survey.visits = Visits(times_s, 3 * kDay_s);
  ChangedCluxels& all = survey.cluxels;
  all.visits = survey.visits;
  all.cluxels.edge_offset.push_back(0);
  for (std::uint32_t i = 0; i < kCluxels; ++i) {
    all.cluxels.name.emplace_back();
    all.cluxels.low_corner.emplace_back(0, 0, 0.3 * i);
    all.cluxels.center.emplace_back(0.2, 0.2, 0.3 * i + 0.15);
    all.cluxels.extent.emplace_back(0.4F, 0.4F, 0.3F);
    if (i > 0) all.cluxels.edge_target.push_back(i - 1);
    if (i + 1 < kCluxels) all.cluxels.edge_target.push_back(i + 1);
    all.cluxels.edge_offset.push_back(static_cast<std::uint32_t>(all.cluxels.edge_target.size()));
    all.number.push_back(i), all.object.push_back(0), all.is_told.push_back(true);
    RayFindings before, after;
    for (std::uint32_t visit = 0; visit < 4; ++visit) {
      RayFindings& found = visit < 3 ? before : after;
      (column.is_there[visit] ? found.hits : found.seen_through) |= scansOnVisit(visit);
    }
    all.before.push_back(before), all.after.push_back(after);
    all.changes.push_back(changeOf(before, after));
  }
  survey.clusters[0] = possibleClusters(CluxelChange::Vanished, all);
  ObjectStates states;
  states.object = 0, states.before = PresenceState::Present, states.after = column.after;
  survey.states = {states};
  survey.stable_of_object[0] = 100;
  return survey;
}

std::size_t goneOf(const Column& column) {
  return changedThings(surveyOfColumn(column)).gone.size();
}

TEST(ChangedThings, APartThatSeemsToComeAndGoInTurnIsMissedByRays) {
  EXPECT_EQ(goneOf({{true, true, true, false}}), 1U);
  EXPECT_EQ(goneOf({{false, true, true, false}}), 1U) << "it came, and left";
  EXPECT_EQ(goneOf({{true, false, true, false}}), 0U);
  EXPECT_EQ(goneOf({{true, false, true, false}, PresenceState::Absent}), 1U) << "all of the object may come and go";
}

}  // namespace
}  // namespace cluxel::tasks
