// SPDX-License-Identifier: Apache-2.0
// Names that have ended lead on in merges where one of the maps tells in what the thing goes on.
#include <gtest/gtest.h>

#include <array>

#include "mapping/change/member_places.hpp"
#include "mapping/living_map.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

/// A thing leaves two copies of a map, and their merge has its members again, in an object of another name.
TEST(EndedNames, LeadOnWhereAnOlderCopyTellsItsMembers) {
  LivingMap old;
  const ObjectMembers lost = thingMembers("lost", {1, 2, 3}), other = thingMembers("other", {11, 12}),
                      scattered = thingMembers("scattered", {21, 22, 23, 24}),
                      back = thingMembers("back", {1, 2, 4, 5}), half = thingMembers("half", {21, 22});
  old.change({lost, other, scattered}, timeOf(10'001));
  LivingMap a(old), b(old);
  a.change({other}, timeOf(10'002));
  b.change({other}, timeOf(10'003));
  const std::vector<ObjectMembers> after{back, half, other};
  const LivingMap both = merged({&a, &b}, after, timeOf(10'004));
  for (const auto& maps : {std::vector<const LivingMap*>{&old, &both}, {&both, &old}, {&a, &old, &both}}) {
    const LivingMap result = merged(maps, after, timeOf(20'000));
    expectSoundNames(result);
    EXPECT_EQ(result.names().thing_of, both.names().thing_of) << "what is there keeps its name";
    const QuadReader quads(result.environment->read());
    const auto found = Lineage(quads, {back.id, half.id, other.id}).find(rdf::iriOfThing(lost.id));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->object, back.id);
    EXPECT_TRUE(ThingLookup(quads).replacementsOf(rdf::iriOfThing(scattered.id)).empty()) << "not most of it";
    EXPECT_EQ(merged({&result, &old}, after, timeOf(30'000)).history(), result.history());
  }
}

/// What stands near is no heir of a thing that a map has ended.
TEST(EndedNames, DoNotLeadToWhatStandsNear) {
  LivingMap old;
  ObjectMembers bush = thingMembers("bush", {1, 2, 3}), wall = thingMembers("wall", {11, 12, 13, 14});
  for (const double x : {0.0, 0.4, 0.8}) bush.places.push_back(placeOf({x, 0, 0}));
  for (const double x : {0.0, 0.4, 0.8, 1.2}) wall.places.push_back(placeOf({x, 0.1, 0}));
  old.change({bush}, timeOf(10'001));
  LivingMap later(old);
  later.change({}, timeOf(10'002));
  later.change({wall}, timeOf(10'003));
  const LivingMap result = merged({&old, &later}, {wall}, timeOf(20'000));
  EXPECT_EQ(result.history(), later.history());
}

TEST(EndedNames, LeadOnFromWhicheverObjectHasAnHeir) {
  for (const bool goes_on_in_a : {false, true}) {
    LivingMap a;
    const ObjectMembers oldest = thingMembers("oldest", {11, 12, 13, 14}), thing = thingMembers("thing", {1, 2, 3, 4});
    a.change({oldest}, timeOf(10'001));
    a.change({oldest, thing}, timeOf(10'002));
    LivingMap b(a);
    a.change({oldest, thingMembers("in a", {1, 2})}, timeOf(10'003));
    b.change({oldest, thingMembers("in b", {3, 4})}, timeOf(10'004));
    ObjectMembers joined = thingMembers("joined", {11, 12, 13, 14});
    for (const std::uint64_t seed : goes_on_in_a ? std::array{1, 2} : std::array{3, 4}) joined.seeds.push_back(seed);
    const LivingMap result = merged({&a, &b}, {joined}, timeOf(20'000));
    expectSoundNames(result);
    const std::vector<Term> heirs =
        ThingLookup(QuadReader(result.environment->read())).replacementsOf(rdf::iriOfThing(thing.id));
    ASSERT_EQ(heirs.size(), 1U);
    EXPECT_EQ(heirs.front().text, rdf::iriOfThing(oldest.id));
  }
}

}  // namespace
}  // namespace cluxel::mapping
