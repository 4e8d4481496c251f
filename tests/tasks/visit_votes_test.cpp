// SPDX-License-Identifier: Apache-2.0
// Visits of scans, and what they tell of a thing.
#include "tasks/changes/visit_votes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tasks/changes/object_states.hpp"

namespace cluxel::tasks {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

ScanNumbers scans(std::initializer_list<std::uint32_t> numbers) {
  ScanNumbers set;
  for (const std::uint32_t number : numbers) set.insert(number);
  return set;
}

TEST(Visits, EndWithAPauseAndWhereTheTimesMeet) {
  const std::vector<double> times_s{0, 60, 4000, 4060, 4120};
  const Visits visits(times_s, 4060);
  EXPECT_EQ(visits.ofScan(1), 0U);
  EXPECT_EQ(visits.ofScan(2), 1U);
  EXPECT_EQ(visits.ofScan(3), 2U);
  EXPECT_EQ(visits.at(4120), 2U);
  EXPECT_FALSE(visits.isAfter(1));
  EXPECT_TRUE(visits.isAfter(2));
}

/// Scans 0 and 1 are of the first visit, scan 2 of the second, scan 3 of the third.
const Visits& threeVisits() {
  static const Visits visits(std::vector<double>{0, 60, 4000, 8000}, 8000);
  return visits;
}

VisitVotes votesOf(std::size_t places, const ScanNumbers& hits, const ScanNumbers& passed) {
  PlaceVotes votes(threeVisits(), places);
  for (std::size_t i = 0; i < places; ++i) votes.addPlace(hits, passed);
  return votes.take();
}

TEST(PlaceVotes, TellsOnWhichVisitsAThingWasThere) {
  EXPECT_THAT(visitsWithIt(votesOf(20, scans({0, 2}), scans({3}))), ElementsAre(0, 1));
  EXPECT_THAT(visitsWithoutIt(votesOf(20, scans({0, 2}), scans({3}))), ElementsAre(2));
  EXPECT_THAT(visitsWithIt(votesOf(20, scans({}), scans({3}))), IsEmpty());
  EXPECT_THAT(visitsWithoutIt(votesOf(20, scans({}), scans({3}))), IsEmpty()) << "it was never there";
}

TEST(PlaceVotes, WhatStoodInSomeOfThePlacesBeforeDoesNotHideThatTheThingWasAway) {
  PlaceVotes votes(threeVisits(), 33);
  for (std::size_t i = 0; i < 33; ++i)
    i < 10 ? votes.addPlace(scans({0, 3}), scans({})) : votes.addPlace(scans({3}), scans({0}));
  EXPECT_THAT(visitsWithoutIt(votes.take()), ElementsAre(0));
}

TEST(PlaceVotes, TellHowOftenAThingCameOrWent) {
  EXPECT_EQ(comingsAndGoings(votesOf(20, scans({0, 2}), scans({3}))), 1U);
  EXPECT_EQ(comingsAndGoings(votesOf(20, scans({0, 3}), scans({2}))), 2U);
  EXPECT_EQ(comingsAndGoings(votesOf(20, scans({0, 3}), scans({}))), 0U) << "one visit tells nothing";
  const VisitVotes first = votesOf(20, scans({0}), scans({2})), last = votesOf(20, scans({3}), scans({}));
  EXPECT_EQ(comingsAndGoings(joined(first, last)), 2U);
}

TEST(PlaceVotes, AVisitOfWhichMostScansPassDoesNotFindTheThing) {
  const Visits visits(std::vector<double>{0, 4000, 4060, 4120, 8000}, 8000);  // the second visit has three scans
  PlaceVotes votes(visits, 20);
  for (std::size_t i = 0; i < 20; ++i)
    i < 14 ? votes.addPlace(scans({1, 4}), scans({0, 2, 3})) : votes.addPlace(scans({4}), scans({0, 1, 2, 3}));
  const VisitVotes found = votes.take();
  EXPECT_THAT(visitsWithIt(found), ElementsAre(1, 2)) << "a place that one scan hits is hit";
  EXPECT_EQ(comingsAndGoings(found), 1U) << "away, away, and there";
}

TEST(PlaceVotes, AnotherScanOfTheVisitThatPassesDoesNotTellThatItLeft) {
  EXPECT_FALSE(isAwayAtEnd(votesOf(20, scans({0}), scans({1}))));
  EXPECT_TRUE(isAwayAtEnd(votesOf(20, scans({0}), scans({1, 2}))));
  EXPECT_FALSE(isAwayAtEnd(votesOf(20, scans({0, 3}), scans({2})))) << "it came back";
}

TEST(PlaceVotes, TakesAnyNumberOfPlaces) {
  for (const std::size_t places : {1U, 255U, 256U, 257U, 5000U}) {
    const VisitVotes votes = votesOf(places, scans({0}), scans({2}));
    ASSERT_THAT(votes.visits, ElementsAre(0, 1));
    EXPECT_EQ(votes.votes[0].hits.count(), std::min<std::size_t>(places, perception::kMaxPlaces));
  }
}

/// A scan that hits the first places and sees through those after them.
perception::ScanVotes vote(double time_s, std::size_t hits, std::size_t seen_through) {
  perception::ScanVotes scan;
  scan.time_s = time_s;
  for (std::size_t i = 0; i < hits; ++i) scan.hits.set(i);
  for (std::size_t i = 0; i < seen_through; ++i) scan.seen_through.set(hits + i);
  return scan;
}

ObjectStates statesOf(const std::vector<perception::ScanVotes>& votes, double since_s,
                      const perception::PlaceSet& hit_by_others = {}) {
  std::vector<double> times_s;
  for (const perception::ScanVotes& vote : votes) times_s.push_back(vote.time_s);
  return tasks::statesOf(0, votes, Visits(times_s, since_s), hit_by_others);
}

TEST(ObjectStates, OneRayThatPassesOnTheSameVisitDoesNotHideThatAThingLeft) {
  constexpr double kDay_s = 86400;
  const auto wasAway = [&](const std::vector<perception::ScanVotes>& history) {
    return statesOf(history, 2 * kDay_s).was_away;
  };
  EXPECT_TRUE(wasAway({vote(0, 60, 0), vote(60, 0, 1), vote(kDay_s, 0, 50), vote(2 * kDay_s, 60, 0)}));
  EXPECT_FALSE(wasAway({vote(0, 60, 0), vote(60, 0, 50), vote(2 * kDay_s, 60, 0)})) << "within one visit";
}

TEST(ObjectStates, AreTheSameWhetherLaterScansThatHitTheThingAreCompared) {
  using perception::PresenceState;
  for (const std::size_t seen_through : {2U, 15U, 19U, 20U, 40U, 100U}) {
    std::vector<perception::ScanVotes> votes{vote(0, 0, seen_through), vote(4000, 0, 0)};
    const perception::PlaceSet hit_later = vote(8000, 100, 0).hits;
    const PresenceState until = statesOf(votes, 4000, hit_later).before;
    votes.push_back(vote(8000, 100, 0));
    EXPECT_EQ(until, statesOf(votes, 4000).before) << seen_through;
    EXPECT_EQ(until, seen_through < 20 ? PresenceState::NotObserved : PresenceState::Absent) << seen_through;
  }
}

TEST(ObjectStates, TellOfWhichShareOfThePlacesTheirScansTell) {
  using perception::PresenceState;
  const auto after = [&](const std::vector<perception::ScanVotes>& later) {
    std::vector<perception::ScanVotes> votes{vote(0, 100, 0)};
    votes.insert(votes.end(), later.begin(), later.end());
    const ObjectStates states = statesOf(votes, 4000);
    EXPECT_EQ(states.coverage_before, 1);
    return std::pair(states.after, states.coverage_after);
  };
  EXPECT_EQ(after({vote(4000, 0, 0)}), std::pair(PresenceState::NotObserved, 0.0));
  EXPECT_EQ(after({vote(4000, 0, 60)}), std::pair(PresenceState::Absent, 0.6));
  EXPECT_EQ(after({vote(4000, 0, 60), vote(4060, 0, 80)}), std::pair(PresenceState::Absent, 0.8)) << "both see it";
  EXPECT_EQ(after({vote(4000, 30, 0), vote(4060, 40, 0)}), std::pair(PresenceState::Present, 0.4));
  EXPECT_EQ(after({vote(4000, 90, 0), vote(8000, 0, 70)}), std::pair(PresenceState::Absent, 0.7)) << "since it left";
  for (std::size_t places = 0; places <= 100; ++places) {
    const auto [state, coverage] = after({vote(4000, 0, places)});
    EXPECT_EQ(state == PresenceState::Absent, coverage >= perception::PresenceParams{}.min_share) << places;
  }
}

TEST(ObjectStates, OneLaterScanTellsThatAllOfAThingIsGone) {
  const auto isAllGone = [&](std::size_t hits, std::size_t seen_through) {
    const std::vector<perception::ScanVotes> votes{vote(0, 100, 0), vote(4000, hits, seen_through)};
    return statesOf(votes, 4000).is_all_gone;
  };
  EXPECT_TRUE(isAllGone(0, 95));
  EXPECT_FALSE(isAllGone(0, 60)) << "a scan sees through many places of a crown";
  EXPECT_FALSE(isAllGone(3, 95)) << "some of it is left";
  std::vector<perception::ScanVotes> elsewhere{vote(0, 10, 0), vote(4000, 0, 0)};
  for (std::size_t place = 10; place < 100; ++place) elsewhere[1].seen_through.set(place);
  EXPECT_FALSE(statesOf(elsewhere, 4000).is_all_gone) << "where it was never hit, it may not have been";
}

}  // namespace
}  // namespace cluxel::tasks
