// SPDX-License-Identifier: Apache-2.0
// Choosing among rivals: against all subsets of small groups, and properties of large ones.
#include <gtest/gtest.h>

#include <random>

#include "rules/decide/rivals.hpp"

namespace cluxel::testing {

using namespace rules;
namespace {

std::vector<Rival> randomRivals(std::mt19937& random, std::size_t count, std::uint32_t items, bool shares) {
  std::vector<Rival> rivals(count);
  for (Rival& rival : rivals) {
    rival.score = static_cast<std::int64_t>(random() % 13) - 2;  // small numbers, so that ties are common
    rival.share_class = random() % 2;
    for (std::uint32_t k = 0; k < 1 + random() % 3; ++k) rival.owned.push_back(random() % items);
    if (shares && random() % 3 == 0) rival.shared.push_back(random() % items);
  }
  return rivals;
}

bool isAllowed(const std::vector<std::vector<std::uint32_t>>& conflicts, std::uint32_t set) {
  for (std::uint32_t i = 0; i < conflicts.size(); ++i)
    for (std::uint32_t other : conflicts[i])
      if ((set >> i & 1U) != 0 && (set >> other & 1U) != 0) return false;
  return true;
}

std::int64_t scoreOf(const std::vector<Rival>& rivals, const std::vector<bool>& chosen) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < rivals.size(); ++i) sum += chosen[i] ? rivals[i].score : 0;
  return sum;
}

TEST(Rivals, AreChosenAsTheBestOfAllSubsets) {
  std::mt19937 random(7);
  for (int round = 0; round < 400; ++round) {
    const auto rivals = randomRivals(random, 1 + random() % 11, 6, true);
    const auto conflicts = conflictsOf(rivals);
    std::int64_t best = 0;
    for (std::uint32_t set = 0; set < 1U << rivals.size(); ++set) {
      if (!isAllowed(conflicts, set)) continue;
      std::int64_t sum = 0;
      for (std::size_t i = 0; i < rivals.size(); ++i) sum += (set >> i & 1U) != 0 ? rivals[i].score : 0;
      best = std::max(best, sum);
    }
    const auto chosen = chooseAmongRivals(rivals);
    std::uint32_t set = 0;
    for (std::size_t i = 0; i < rivals.size(); ++i) set |= chosen[i] ? 1U << i : 0U;
    ASSERT_TRUE(isAllowed(conflicts, set));
    ASSERT_EQ(scoreOf(rivals, chosen), best) << "round " << round;
    for (std::size_t i = 0; i < rivals.size(); ++i) ASSERT_FALSE(chosen[i] && rivals[i].score <= 0);
  }
}

TEST(Rivals, GiveTiesToTheEarlierCandidates) {
  const std::vector<Rival> rivals{
      {5, {1}, {}, 0}, {5, {1}, {}, 0}, {10, {2, 3}, {}, 0}, {5, {2}, {}, 0}, {5, {3}, {}, 0}};
  EXPECT_EQ(chooseAmongRivals(rivals), (std::vector<bool>{true, false, true, false, false}));
}

TEST(Rivals, ShareOnlyWithinAClassAndOnlyWhatBothShare) {
  const std::vector<Rival> same{{5, {1}, {9}, 0}, {5, {2}, {9}, 0}};
  EXPECT_EQ(chooseAmongRivals(same), (std::vector<bool>{true, true}));
  const std::vector<Rival> other_class{{5, {1}, {9}, 0}, {6, {2}, {9}, 1}};
  EXPECT_EQ(chooseAmongRivals(other_class), (std::vector<bool>{false, true}));
  const std::vector<Rival> owned_by_one{{5, {1}, {9}, 0}, {6, {2, 9}, {}, 0}};
  EXPECT_EQ(chooseAmongRivals(owned_by_one), (std::vector<bool>{false, true}));
}

TEST(Rivals, InLargeGroupsCannotBeImprovedByOneExchange) {
  std::mt19937 random(11);
  for (int round = 0; round < 30; ++round) {
    auto rivals = randomRivals(random, 120, 40, false);
    for (Rival& rival : rivals) rival.score = 1 + static_cast<std::int64_t>(random() % 1000);
    const auto conflicts = conflictsOf(rivals);
    const auto chosen = chooseAmongRivals(rivals);
    for (std::size_t i = 0; i < rivals.size(); ++i) {
      std::int64_t blockers = 0;
      for (std::uint32_t other : conflicts[i]) {
        ASSERT_FALSE(chosen[i] && chosen[other]);
        blockers += chosen[other] ? rivals[other].score : 0;
      }
      if (!chosen[i]) {
        EXPECT_LE(rivals[i].score, blockers);
      }
    }
  }
}

}  // namespace
}  // namespace cluxel::testing
