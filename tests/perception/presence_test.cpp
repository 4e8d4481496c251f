// SPDX-License-Identifier: Apache-2.0
// When a thing was there: compared with a search over all intervals, and on histories with an obvious answer.
#include "perception/visibility/presence.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <optional>
#include <random>

namespace cluxel::perception {
namespace {

ScanVotes votes(double time_s, std::size_t hits, std::size_t seen_through) {
  ScanVotes scan;
  scan.time_s = time_s;
  for (std::size_t i = 0; i < hits; ++i) scan.hits.set(i);
  for (std::size_t i = 0; i < seen_through; ++i) scan.seen_through.set(hits + i);
  return scan;
}

/// Each scan is a visit.
PresenceState stateAfter(const std::vector<ScanVotes>& history, const Visibility& thing, const PresenceParams& params) {
  std::vector<std::uint32_t> visits(history.size());
  std::iota(visits.begin(), visits.end(), 0U);
  return stateAtEnd(history, visits, thing, params).state;
}

PresenceState stateOf(const std::vector<ScanVotes>& history) {
  return stateAfter(history, visibilityOf(history), {});
}

TEST(Presence, ScansOfOneTimeSpeakTogether) {
  std::vector<ScanVotes> history;
  addVotes(history, votes(1, 0, 40));
  addVotes(history, votes(1, 10, 0));
  addVotes(history, votes(2, 0, 5));
  ASSERT_EQ(history.size(), 2);
  EXPECT_EQ(history[0].hits.count(), 10);
  EXPECT_EQ(history[0].seen_through.count(), 30);  // what one of them hit, no other saw through
  EXPECT_EQ(history[1].time_s, 2);
}

struct Times {
  std::size_t begin = 0, end = 0;
  double sum = 0;
};

/// The scans in [from, to) with the largest sum, by trying all.
Times largestIn(const std::vector<ScanVotes>& history, std::size_t from, std::size_t to, const Visibility& thing) {
  Times best;
  for (std::size_t begin = from; begin < to; ++begin)
    for (std::size_t end = begin + 1; end <= to; ++end) {
      const double sum =
          logOddsOfPresence(std::span(history).subspan(begin, end - begin), thing.share_of_hits, PresenceParams{});
      if (sum > best.sum) best = {begin, end, sum};
    }
  return best;
}

TEST(Presence, GoesFromTheFirstToTheLastIntervalThatSpeaksForIt) {
  std::mt19937 random(11);
  std::size_t several = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<ScanVotes> history;
    const std::size_t count = 1 + random() % 9;
    for (std::size_t i = 0; i < count; ++i)
      history.push_back(votes(static_cast<double>(i), random() % 3 == 0 ? random() % 20 : 0, 1 + random() % 30));
    const Visibility thing = visibilityOf(history);
    const Times best = largestIn(history, 0, count, thing);
    const auto presence = presenceOf(history, thing, {});
    ASSERT_EQ(presence.has_value(), best.sum > 0);
    if (!presence) continue;
    const double decided = PresenceParams{}.decided;
    std::size_t begin = best.begin, end = best.end;
    for (Times next = largestIn(history, end, count, thing); next.sum >= decided;
         next = largestIn(history, end, count, thing))
      end = next.end;
    for (Times next = largestIn(history, 0, begin, thing); next.sum >= decided;
         next = largestIn(history, 0, begin, thing))
      begin = next.begin;
    several += begin < best.begin || end > best.end ? 1 : 0;
    ASSERT_EQ(presence->first_seen_s, static_cast<double>(begin));
    ASSERT_EQ(presence->last_seen_s, static_cast<double>(end - 1));
    EXPECT_TRUE(history[begin].hits.any());
    EXPECT_TRUE(history[end - 1].hits.any());
  }
  EXPECT_GT(several, 20U);
}

TEST(Presence, OfWhatCameBackHasNoEnd) {
  const ScanVotes there = votes(0, 50, 2), away = votes(0, 0, 40), few = votes(0, 12, 0);
  const auto inTurn = [](std::vector<ScanVotes> history) {
    for (std::size_t i = 0; i < history.size(); ++i) history[i].time_s = static_cast<double>(i);
    return history;
  };
  const std::vector<ScanVotes> back = inTurn({there, there, there, away, away, few});
  const auto presence = presenceOf(back, visibilityOf(back), {});
  ASSERT_TRUE(presence.has_value());
  EXPECT_EQ(presence->first_seen_s, 0);
  EXPECT_EQ(presence->last_seen_s, 5);
  EXPECT_FALSE(presence->seen_through_s.has_value());
  EXPECT_EQ(stateOf(back), PresenceState::Present);
  const std::vector<ScanVotes> came_twice = inTurn({away, few, away, there, there, there});
  const auto twice = presenceOf(came_twice, visibilityOf(came_twice), {});
  ASSERT_TRUE(twice.has_value());
  EXPECT_EQ(twice->first_seen_s, 1);
  EXPECT_EQ(twice->seen_empty_s, 0);
}

TEST(Presence, IsMirroredWhenTimeRunsBackwards) {
  std::mt19937 random(12);
  std::size_t left = 0, came = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<ScanVotes> history;
    double time_s = 0;
    for (std::size_t i = 2 + random() % 7; i > 0; --i) {
      time_s += random() % 3 == 0 ? 4000 : 60;
      history.push_back(votes(time_s, random() % 2 == 0 ? 5 + random() % 30 : 0, 1 + random() % 30));
    }
    std::vector<ScanVotes> mirrored(history.rbegin(), history.rend());
    for (ScanVotes& vote : mirrored) vote.time_s = -vote.time_s;
    const auto there = presenceOf(history, visibilityOf(history), {}),
               back = presenceOf(mirrored, visibilityOf(mirrored), {});
    ASSERT_EQ(there.has_value(), back.has_value());
    if (!there) continue;
    const auto negative = [](const std::optional<double>& at) { return at ? std::optional(-*at) : std::nullopt; };
    EXPECT_EQ(there->first_seen_s, -back->last_seen_s);
    EXPECT_EQ(there->last_seen_s, -back->first_seen_s);
    EXPECT_EQ(there->seen_through_s, negative(back->seen_empty_s));
    EXPECT_EQ(there->seen_empty_s, negative(back->seen_through_s));
    left += there->seen_through_s ? 1 : 0, came += there->seen_empty_s ? 1 : 0;
  }
  EXPECT_GT(left, 20U);
  EXPECT_GT(came, 20U);
}

TEST(Presence, NothingLeavesWithinOneVisit) {
  const std::vector<ScanVotes> history{votes(1, 12, 0), votes(2, 4, 7)};
  const Visibility sign = visibilityOf(std::vector<ScanVotes>{votes(0, 12, 0), votes(3, 12, 0)});
  const std::vector<std::uint32_t> one_visit{0, 0}, two_visits{0, 1};
  const StateAtEnd there = stateAtEnd(history, one_visit, sign, {}), away = stateAtEnd(history, two_visits, sign, {});
  EXPECT_EQ(there.state, PresenceState::Present);
  EXPECT_GT(there.log_odds, 6);
  EXPECT_EQ(away.state, PresenceState::Absent);
  EXPECT_LT(away.log_odds, -6);
}

TEST(Presence, OneWeakHitDoesNotOutweighWhatIsSeenThrough) {
  const std::vector<ScanVotes> before{votes(1, 50, 2)};
  std::vector<ScanVotes> after{votes(2, 0, 40), votes(3, 0, 0)};
  after[1].hits.set(60);
  EXPECT_EQ(stateAfter(after, visibilityOf(before), {}), PresenceState::Absent);
}

TEST(Presence, OneWeakHitIsNothingWhereMoreIsSeenThroughSince) {
  const Visibility thing = visibilityOf(std::vector<ScanVotes>{votes(0, 200, 0)});
  const ScanVotes hit = votes(1, 1, 0), through = votes(2, 0, 20);
  ASSERT_FALSE(showAbsence(std::vector<ScanVotes>{hit, through}, thing, {})) << "a tenth of it was seen through";
  EXPECT_EQ(stateAfter({hit}, thing, {}), PresenceState::Present);
  EXPECT_EQ(stateAfter({hit, through}, thing, {}), PresenceState::NotObserved);
  EXPECT_EQ(stateAfter({through, hit}, thing, {}), PresenceState::Present) << "it may have come since";
  EXPECT_EQ(stateAfter({votes(0, 3, 0), through}, thing, {}), PresenceState::Present) << "surely seen";
}

TEST(Presence, SeesACarLeaveAndArrive) {
  const std::vector<ScanVotes> left{votes(1, 50, 2), votes(2, 60, 0), votes(3, 0, 40), votes(4, 0, 50)};
  const auto gone = presenceOf(left, visibilityOf(left), {});
  ASSERT_TRUE(gone.has_value());
  EXPECT_EQ(gone->last_seen_s, 2);
  EXPECT_EQ(gone->seen_through_s, 3);
  EXPECT_FALSE(gone->seen_empty_s.has_value());
  EXPECT_EQ(stateOf(left), PresenceState::Absent);
  const std::vector<ScanVotes> arrived{votes(1, 0, 40), votes(2, 0, 30), votes(3, 50, 1)};
  const auto come = presenceOf(arrived, visibilityOf(arrived), {});
  ASSERT_TRUE(come.has_value());
  EXPECT_EQ(come->seen_empty_s, 2);
  EXPECT_EQ(come->first_seen_s, 3);
  EXPECT_EQ(stateOf(arrived), PresenceState::Present);
}

TEST(Presence, KeepsWhatOnlyAFarScanSeesThroughAtTheEdge) {
  std::vector<ScanVotes> tree;
  for (int i = 0; i < 5; ++i) tree.push_back(votes(i, 120, 60));
  tree.push_back(votes(5, 0, 12));  // 12 places of 120
  EXPECT_EQ(stateOf(tree), PresenceState::Present);
}

TEST(Presence, IsNotObservedWithoutEvidence) {
  const std::vector<ScanVotes> before{votes(1, 50, 2)};
  EXPECT_EQ(stateAfter({}, visibilityOf(before), {}), PresenceState::NotObserved);
  const std::vector<ScanVotes> few{votes(2, 0, 1)};
  EXPECT_EQ(stateAfter(few, visibilityOf(before), {}), PresenceState::NotObserved);
  const std::vector<ScanVotes> many{votes(2, 0, 30)};
  EXPECT_EQ(stateAfter(many, visibilityOf(before), {}), PresenceState::Absent);
}

TEST(Presence, OfWhatNoScanHitIsNotObserved) {
  const std::vector<ScanVotes> through{votes(1, 0, 40), votes(2, 0, 40)};
  EXPECT_FALSE(showAbsence(through, visibilityOf(through), {}));
  EXPECT_EQ(stateOf(through), PresenceState::NotObserved);
}

TEST(Presence, NeedsMoreEvidenceThatAThingRaysOftenMissIsGone) {
  const std::vector<ScanVotes> solid{votes(1, 20, 0)}, thin{votes(1, 8, 12), votes(2, 8, 12)};
  const std::vector<ScanVotes> later{votes(3, 0, 5)};
  EXPECT_EQ(stateAfter(later, visibilityOf(solid), {}), PresenceState::Absent);
  EXPECT_EQ(stateAfter(later, visibilityOf(thin), {}), PresenceState::NotObserved);
}

}  // namespace
}  // namespace cluxel::perception
