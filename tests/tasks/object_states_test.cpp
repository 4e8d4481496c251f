// SPDX-License-Identifier: Apache-2.0
// What the votes of visits tell of an object before and after a time.
#include "tasks/changes/object_states.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace cluxel::tasks {
namespace {

using perception::PresenceState;
using perception::ScanVotes;

constexpr double kBetweenScans_s = 86400;  ///< each is a visit

/// Votes of one scan a day; the numbers of hits, and of places seen through.
struct Looks {
  std::size_t hits = 0, through = 0;
};
std::vector<ScanVotes> daily(const std::vector<Looks>& looks) {
  std::vector<ScanVotes> votes;
  for (const Looks& look : looks) {
    ScanVotes& scan = votes.emplace_back();
    scan.time_s = kBetweenScans_s * static_cast<double>(votes.size());
    for (std::size_t i = 0; i < look.hits; ++i) scan.hits.set(i);
    for (std::size_t i = look.hits; i < look.hits + look.through; ++i) scan.seen_through.set(i);
  }
  return votes;
}

/// Those from the scan `since` on are later.
ObjectStates statesSince(const std::vector<ScanVotes>& votes, std::size_t since) {
  std::vector<double> times_s;
  for (const ScanVotes& scan : votes) times_s.push_back(scan.time_s);
  return statesOf(0, votes, Visits(times_s, times_s[since]));
}

const Looks kThere{50, 2}, kAway{0, 52}, kOnePoint{1, 0};

TEST(ObjectStates, OnePointIsNoReturnOfWhatLeft) {
  const ObjectStates weak = statesSince(daily({kThere, kAway, kOnePoint}), 2);
  EXPECT_EQ(weak.before, PresenceState::Absent);
  EXPECT_FALSE(changedAsWhole(weak)) << "the map says that it is gone";
  const ObjectStates back = statesSince(daily({kThere, kAway, kThere}), 2);
  EXPECT_EQ(back.after, PresenceState::Present);
  EXPECT_TRUE(changedAsWhole(back));
}

TEST(ObjectStates, WhatOnlyOnePointShowedBeforeHasNotVanished) {
  const ObjectStates weak = statesSince(daily({kOnePoint, kThere, kAway}), 1);
  EXPECT_EQ(weak.after, PresenceState::Absent);
  EXPECT_FALSE(changedAsWhole(weak)) << "it came and left again";
  EXPECT_TRUE(changedAsWhole(statesSince(daily({kThere, kThere, kAway}), 1)));
}

/// Both sides of a change as a whole are decided: by votes of log-odds 6 or more, and of -6 or less.
TEST(ObjectStates, AChangeAsAWholeIsSureOfBothTimes) {
  std::mt19937 random(5);
  std::size_t changed = 0, weak = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<Looks> looks(2 + random() % 5);
    for (Looks& look : looks)
      look = random() % 4 == 0   ? kOnePoint
             : random() % 2 == 0 ? Looks{random() % 30, random() % 4}
                                 : Looks{0, random() % 60};
    const ObjectStates states = statesSince(daily(looks), 1 + random() % (looks.size() - 1));
    const bool differ = (states.before == PresenceState::Present && states.after == PresenceState::Absent) ||
                        (states.before == PresenceState::Absent && states.after == PresenceState::Present);
    const double there = states.before == PresenceState::Present ? states.log_odds_before : states.log_odds_after,
                 away = states.before == PresenceState::Present ? states.log_odds_after : states.log_odds_before;
    weak += differ && there < 6 ? 1 : 0;
    if (!changedAsWhole(states)) continue;
    ++changed;
    EXPECT_TRUE(differ);
    EXPECT_GE(there, 6);
    EXPECT_LE(away, -6);
  }
  EXPECT_GT(changed, 50U);
  EXPECT_GT(weak, 50U);
}

}  // namespace
}  // namespace cluxel::tasks
