// SPDX-License-Identifier: Apache-2.0
// What the grid of a crown shows, against a look at all of its cluxels.
#include "rules/objects/jump_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace cluxel::testing {

using namespace rules;
namespace {

/// Cluxels far from the origin of the map, some of which are reached or removed.
class JumpGridTest : public ::testing::Test {
 protected:
  JumpGridTest() {
    std::uniform_real_distribution<double> place(0, 8), half(0.05, 0.4);
    for (int i = 0; i < 600; ++i)
      entries_.push_back({corner_ + Eigen::Vector3d(place(random_), place(random_), place(random_) / 2),
                          static_cast<float>(half(random_))});
    lengths_.resize(entries_.size(), std::numeric_limits<double>::infinity());
  }

  void change(JumpGrid& grid) {
    std::uniform_int_distribution<std::uint32_t> number(0, static_cast<std::uint32_t>(entries_.size()) - 1);
    std::uniform_real_distribution<double> length(0, 10);
    for (int i = 0; i < 20; ++i) {
      const std::uint32_t reached = number(random_), gone = number(random_);
      lengths_[reached] = std::min(lengths_[reached], length(random_));
      grid.reach(reached, lengths_[reached]);
      if (i % 2 == 0) grid.remove(gone), gone_.insert(gone);
    }
  }

  std::mt19937 random_{7};
  Eigen::Vector3d corner_{4.5e5, -5.4e6, 112};
  std::vector<JumpGrid::Entry> entries_;
  std::vector<double> lengths_;
  std::set<std::uint32_t> gone_;
};

TEST_F(JumpGridTest, ShowsAllThatAJumpReachesOnAShorterPathAndNothingThatIsGone) {
  JumpGrid grid(entries_, 0.6);
  std::uniform_real_distribution<double> place(-1, 9), length(0, 10);
  std::size_t nearer = 0, shown = 0;
  for (int round = 0; round < 100; ++round, change(grid)) {
    const Eigen::Vector3d from = corner_ + Eigen::Vector3d(place(random_), place(random_), place(random_) / 2);
    const double reach = 0.8, way = length(random_);
    std::set<std::uint32_t> found;
    grid.nearer({from, reach, way}, [&](std::uint32_t at) { found.insert(at); });
    for (const std::uint32_t at : found) EXPECT_FALSE(gone_.contains(at));
    for (std::uint32_t at = 0; at < entries_.size(); ++at) {
      const double distance = (entries_[at].centre - from).norm();
      if (gone_.contains(at) || distance > reach + static_cast<double>(entries_[at].half_m) ||
          way + kJumpPenalty * distance >= lengths_[at])
        continue;
      EXPECT_TRUE(found.contains(at)) << "cluxel " << at;
      ++nearer;
    }
    shown += found.size();
  }
  EXPECT_GT(nearer, 100U);
  EXPECT_LT(shown, 2 * nearer);
}

TEST_F(JumpGridTest, ShowsAllInABox) {
  JumpGrid grid(entries_, 0.6);
  std::uniform_real_distribution<double> place(-1, 9);
  for (int round = 0; round < 50; ++round, change(grid)) {
    const Eigen::Vector3d low = corner_ + Eigen::Vector3d(place(random_), place(random_), place(random_) / 2);
    const Eigen::Vector3d high = low + Eigen::Vector3d(2, 3, 1);
    std::set<std::uint32_t> found;
    grid.within(low, high, [&](std::uint32_t at) { found.insert(at); });
    for (std::uint32_t at = 0; at < entries_.size(); ++at) {
      const Eigen::Array3d centre = entries_[at].centre.array();
      const bool is_inside = (centre >= low.array()).all() && (centre <= high.array()).all();
      EXPECT_TRUE(!is_inside || gone_.contains(at) || found.contains(at)) << "cluxel " << at;
    }
    for (const std::uint32_t at : found) EXPECT_FALSE(gone_.contains(at));
  }
}

}  // namespace
}  // namespace cluxel::testing
