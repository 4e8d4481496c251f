// SPDX-License-Identifier: Apache-2.0
// Groups of what changed alike, on items in a row.
#include "tasks/changes/change_groups.hpp"

#include <gtest/gtest.h>

namespace cluxel::tasks {
namespace {

using enum ChangeState;

/// Items in a row; each is near those beside it.
ChangeGroups row(std::vector<ChangeState> states) {
  const auto count = static_cast<std::uint32_t>(states.size());
  return {std::move(states), [count](std::uint32_t item, const ChangeGroups::Visit& visit) {
            if (item > 0) visit(item - 1);
            if (item + 1 < count) visit(item + 1);
          }};
}

TEST(ChangeGroups, HoldChangedItemsThatHangTogether) {
  const auto groups = row({Changed, Changed, Undecided, Changed, Changed, Changed}).all(2);
  EXPECT_EQ(groups, (std::vector<ChangeGroup>{{0, 1}, {3, 4, 5}}));
}

TEST(ChangeGroups, LeaveOutSmallOnes) {
  const auto groups = row({Changed, Changed, Undecided, Changed, Changed, Changed}).all(3);
  EXPECT_EQ(groups, (std::vector<ChangeGroup>{{3, 4, 5}}));
}

TEST(ChangeGroups, LeaveOutItemsThatMostOfTheirNeighboursContradict) {
  const auto groups = row({Stable, Changed, Changed, Changed, Stable}).all(1);
  EXPECT_EQ(groups, (std::vector<ChangeGroup>{{2}}));
}

TEST(ChangeGroups, ConnectedItemsNeedNoAgreement) {
  const auto groups = row({Stable, Changed, Stable, Changed, Changed, Stable}).connected();
  EXPECT_EQ(groups, (std::vector<ChangeGroup>{{1}, {3, 4}}));
}

TEST(ChangeGroups, ShareOfChangedCountsDecidedItems) {
  const ChangeGroups groups = row({Stable, Changed, Changed, Undecided});
  const ChangeGroup around = groups.withNear({1, 2});
  EXPECT_EQ(around, (ChangeGroup{0, 1, 2, 3}));
  EXPECT_DOUBLE_EQ(groups.shareOfChanged(around), 2.0 / 3);
}

TEST(ChangeGroups, ShareOfChangedAboveLeavesOutWhatLiesBelowTheMiddleOfTheGroup) {
  const ChangeGroups groups = row({Stable, Changed, Changed, Changed, Stable});
  EXPECT_DOUBLE_EQ(groups.shareOfChangedAbove({1, 2, 3}, [](std::uint32_t item) { return item; }), 2.0 / 3);
  EXPECT_DOUBLE_EQ(groups.shareOfChangedAbove({1, 2, 3}, [](std::uint32_t item) { return item == 2 ? 1 : 0; }), 0.6);
  EXPECT_DOUBLE_EQ(groups.shareOfChangedAbove({1, 2, 3}, [](std::uint32_t item) { return item % 4 == 0 ? 0 : 1; }), 1);
}

}  // namespace
}  // namespace cluxel::tasks
