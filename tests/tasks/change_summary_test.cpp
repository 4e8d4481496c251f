// SPDX-License-Identifier: Apache-2.0
// The line that sums up what changed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {
namespace {

using perception::PresenceState;
using testing::ElementsAre;
using testing::IsEmpty;

ObjectStates statesOf(std::uint32_t object, PresenceState before, PresenceState after) {
  ObjectStates states;
  states.object = object, states.before = before, states.after = after;
  return states;
}

SiteChanges changesOfFive() {
  SiteChanges changes;
  changes.times.since_s = 1.7e9;
  changes.states = {statesOf(0, PresenceState::Present, PresenceState::Present),
                    statesOf(1, PresenceState::Present, PresenceState::Absent),
                    statesOf(2, PresenceState::Absent, PresenceState::Present),
                    statesOf(3, PresenceState::Present, PresenceState::NotObserved),
                    statesOf(4, PresenceState::NotObserved, PresenceState::Present)};
  return changes;
}

SiteChange changeOf(SiteChange::Kind kind, std::uint32_t object) {
  SiteChange change;
  change.kind = kind, change.thing.object = object;
  return change;
}

TEST(ChangeSummary, TellsObjectsThatOnlyTheirStatesCallGoneOrNew) {
  SiteChanges changes = changesOfFive();
  EXPECT_THAT(objectsThatDifferByStates(changes), ElementsAre(1, 2));
  EXPECT_EQ(summaryOf(changes),
            "since 2023-11-14T22:13:20.000000Z: 0 changes; 3 objects are there, 1 was not observed again; 2 more came "
            "or went by the states alone, which is less sure");
}

TEST(ChangeSummary, DoesNotCountObjectsThatAChangeNames) {
  SiteChanges changes = changesOfFive();
  changes.changes = {changeOf(SiteChange::Kind::Moved, 1)};
  changes.changes[0].now = ChangedThing();
  changes.changes[0].now->object = 2;
  changes.times.until_s = 1.7e9 + 60;
  EXPECT_THAT(objectsThatDifferByStates(changes), IsEmpty());
  EXPECT_EQ(summaryOf(changes),
            "since 2023-11-14T22:13:20.000000Z until 2023-11-14T22:14:20.000000Z: 1 change; 3 objects are there, 1 "
            "was not observed again");
}

}  // namespace
}  // namespace cluxel::tasks
