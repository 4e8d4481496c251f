// SPDX-License-Identifier: Apache-2.0
// Objects go on where they are when other points have become seeds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <set>

#include "mapping/change/object_successors.hpp"

namespace cluxel::mapping {
namespace {

std::uint64_t next_seed = 1;

ObjectMembers objectAt(const std::string& name, const std::vector<Eigen::Vector3d>& places) {
  ObjectMembers object;
  object.id = ContentHasher().addText(name).finish();
  for (const Eigen::Vector3d& place : places) {
    object.seeds.push_back(next_seed++);
    object.places.push_back(placeOf(place));
  }
  return object;
}

TEST(MemberPlaces, AnObjectGoesOnWhereItIs) {
  const std::vector<ObjectMembers> before{objectAt("pole", {{0, 0, 0}, {0, 0, 0.3}, {0, 0, 0.6}}),
                                          objectAt("bin", {{9, 0, 0}, {9, 0, 0.3}}),
                                          objectAt("gone", {{20, 0, 0}, {20, 0, 0.3}})};
  const std::vector<ObjectMembers> after{
      objectAt("pole with a sign", {{0.1, 0, 0.1}, {0.1, 0, 0.35}, {0, 0.1, 0.6}, {0, 0.5, 0.6}, {0, 0.8, 0.6}}),
      objectAt("beside the bin", {{9.2, 0, 0}, {9.2, 0, 0.3}}), objectAt("bin again", {{9, 0.1, 0}, {9, 0.1, 0.3}}),
      objectAt("new", {{30, 0, 0}})};
  ObjectChanges changes = compareStates(before, after);
  EXPECT_EQ(changes.gone, std::vector{before[2].id});
  ASSERT_EQ(changes.changed.size(), 2U);
  for (const DerivedObject& changed : changes.changed) {
    const bool is_pole = changed.id == after[0].id;
    EXPECT_TRUE(is_pole || changed.id == after[2].id) << "the bin goes on in what is nearest";
    EXPECT_EQ(changed.from, std::vector{before[is_pole ? 0 : 1].id});
  }
  EXPECT_THAT(changes.added, testing::UnorderedElementsAre(after[1].id, after[3].id));
}

/// A pipe in front of a wall goes away with the scan that saw it; of the wall some seeds stay.
TEST(MemberPlaces, WhatIsGoneDoesNotGoOnInItsNeighbour) {
  std::vector<Eigen::Vector3d> wall_places;
  for (int i = 0; i < 10; ++i) wall_places.emplace_back(0.2 * i, 0, 1);
  const ObjectMembers wall = objectAt("wall", wall_places);
  const ObjectMembers pipe = objectAt("pipe", {{0.4, 0.15, 1}, {0.4, 0.15, 1.2}});
  ObjectMembers later = objectAt("wall without the pipe", wall_places);
  std::copy_n(wall.seeds.begin(), 8, later.seeds.begin());
  const ObjectChanges changes = compareStates({wall, pipe}, {later});
  EXPECT_EQ(changes.gone, std::vector{pipe.id});
  EXPECT_EQ(changes.changed.size(), 1U);
  EXPECT_TRUE(changes.joined.empty());
}

TEST(MemberPlaces, OfManyThatLieNearestToOneOneCounts) {
  std::vector<Eigen::Vector3d> hedge;
  for (int i = 0; i < 30; ++i) hedge.emplace_back(0.1 * i, 0, 0);
  std::vector<Eigen::Vector3d> again = hedge;
  for (Eigen::Vector3d& place : again) place.z() = 0.06;
  const ObjectMembers before = objectAt("hedge", hedge), after = objectAt("hedge again", again),
                      bin = objectAt("bin", {{3.05, 0.05, 0}, {3.3, 0, 0}, {3.3, 0.2, 0}});
  const ObjectChanges changes =
      compareStates({before}, bin.id < after.id ? std::vector{bin, after} : std::vector{after, bin});
  EXPECT_EQ(changes.added, std::vector{bin.id});
  EXPECT_EQ(changes.changed.size(), 1U);
}

TEST(MemberPlaces, SeedsCountBeforePlaces) {
  ObjectMembers before = objectAt("before", {{0, 0, 0}, {1, 0, 0}});
  ObjectMembers moved = objectAt("moved", {{5, 0, 0}, {6, 0, 0}});
  moved.seeds = before.seeds;
  const ObjectMembers there = objectAt("there", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  const std::vector<ObjectMembers> after{moved, there};
  const auto successors = successorsOf({&before}, ObjectsOf::OneMap, listOf(after));
  ASSERT_EQ(successors.front().size(), 1U);
  EXPECT_EQ(successors.front()[0].other, 0U) << "by its seeds";
  before.places.clear();
  EXPECT_EQ(successorsOf({&before}, ObjectsOf::OneMap, listOf(after)).front().size(), 1U)
      << "without places by its seeds alone";
}

/// In a merge a scrap has the seeds that stayed; the body, of which the seeds changed, holds seeds of another map.
TEST(MemberPlaces, ABodyGoesOnThoughAScrapHasTheSeedsThatStayed) {
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < 12; ++i) places.emplace_back(i, 0, 0);
  const ObjectMembers whole = objectAt("whole", places), of_other_map = objectAt("other map", {places[4], places[5]});
  ObjectMembers scrap = objectAt("scrap", {places[0], places[1]});
  ObjectMembers body = objectAt("body", {places.begin() + 2, places.end()});
  std::copy_n(whole.seeds.begin(), 2, scrap.seeds.begin());
  std::copy_n(of_other_map.seeds.begin(), 2, body.seeds.begin() + 2);
  const auto successors = successorsOf({&whole, &of_other_map}, ObjectsOf::SeveralMaps, {&scrap, &body});
  ASSERT_EQ(successors[0].size(), 2U);
  EXPECT_EQ(successors[0][0].count, 2U);
  EXPECT_EQ(successors[0][1].count, 10U) << "most of it is there";
  ASSERT_EQ(successors[1].size(), 1U);
  EXPECT_EQ(successors[1][0].other, 1U);
}

TEST(MemberPlaces, AnObjectGoesOnInThatOfItsNameWhateverItGains) {
  ObjectMembers before = objectAt("ground", {{0, 0, 0}});
  before.places.clear();
  ObjectMembers after = objectAt("ground", std::vector<Eigen::Vector3d>(50, {0, 0, 0}));
  after.places.clear();
  const ObjectChanges changes = compareObjects({before, before}, {after});
  EXPECT_TRUE(changes.isEmpty());
  EXPECT_EQ(changes.unchanged, 1U);
}

/// Each member looks at all members of all others.
std::vector<std::vector<std::size_t>> sharedByLooking(const std::vector<ObjectMembers>& some,
                                                      const std::vector<ObjectMembers>& others) {
  const auto decoded = [](MemberPlace place) {
    Eigen::Vector3d steps;
    for (int axis = 0; axis < 3; ++axis) steps[axis] = static_cast<double>((place >> (21 * axis)) & 0x1FFFFFU);
    return steps;
  };
  const auto has = [](const ObjectMembers& object, std::uint64_t seed) {
    return std::count(object.seeds.begin(), object.seeds.end(), seed) > 0;
  };
  std::vector<std::vector<std::size_t>> shared(some.size(), std::vector<std::size_t>(others.size(), 0));
  for (std::size_t object = 0; object < some.size(); ++object) {
    std::set<std::pair<std::size_t, std::size_t>> met;
    for (std::size_t member = 0; member < some[object].seeds.size(); ++member) {
      std::optional<std::size_t> owner;
      for (std::size_t other = 0; other < others.size() && !owner; ++other)
        if (has(others[other], some[object].seeds[member])) owner = other;
      if (owner) ++shared[object][*owner];
      if (owner || some[object].placeOf(member) == kNoMemberPlace) continue;
      double nearest = 36;  // 0.3 m in steps of 5 cm, squared
      std::size_t number = 0;
      for (std::size_t other = 0; other < others.size(); ++other)
        for (std::size_t i = 0; i < others[other].places.size(); ++i) {
          const MemberPlace place = others[other].places[i];
          const double distance = (decoded(place) - decoded(some[object].placeOf(member))).squaredNorm();
          const bool is_better =
              distance < nearest || (distance == nearest && (!owner || others[other].id < others[*owner].id));
          const bool is_held = std::any_of(
              some.begin(), some.end(), [&](const ObjectMembers& known) { return has(known, others[other].seeds[i]); });
          if (place != kNoMemberPlace && !is_held && is_better) owner = other, number = i, nearest = distance;
        }
      if (owner && met.emplace(*owner, number).second) ++shared[object][*owner];
    }
  }
  return shared;
}

TEST(MemberPlaces, TheNearestMemberIsFoundAsByLookingAtAll) {
  std::mt19937 random(3);
  const auto within = [&](double extent) { return extent * (static_cast<double>(random() % 10001U) / 10000 - 0.5); };
  std::size_t found = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<ObjectMembers> some, others;
    for (auto* objects : {&some, &others})
      for (int i = 0; i < 6; ++i) {
        std::vector<Eigen::Vector3d> places;
        for (std::size_t member = 0; member <= random() % 8; ++member)
          places.emplace_back(within(2), within(2), within(1));
        objects->push_back(objectAt(std::to_string(round) + std::to_string(objects->size()), places));
        if (random() % 3 == 0) objects->back().places.front() = kNoMemberPlace;
      }
    for (ObjectMembers& object : some)
      if (random() % 2 == 0) object.seeds.front() = others[random() % others.size()].seeds.front();
    const auto expected = sharedByLooking(some, others);
    const auto shared = sharedBySeedOrPlace(listOf(some), ObjectsOf::OneMap, listOf(others));
    for (std::size_t object = 0; object < some.size(); ++object) {
      std::vector<std::size_t> counts(others.size(), 0);
      for (const SharedMembers& with : shared[object]) counts[with.other] = with.count;
      ASSERT_EQ(counts, expected[object]);
      found += shared[object].size();
    }
  }
  EXPECT_GT(found, 500U);
}

}  // namespace
}  // namespace cluxel::mapping
