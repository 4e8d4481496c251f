// SPDX-License-Identifier: Apache-2.0
// Objects go on where they are when other points have become seeds.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

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
  ASSERT_EQ(changes.changed.size(), 1U);
  EXPECT_EQ(changes.changed.front().id, after[0].id);
  EXPECT_EQ(changes.changed.front().from, std::vector{before[0].id});
  EXPECT_EQ(changes.split.size(), 2U) << "the bin goes on in what is nearest; what stands beside it comes from it, too";
  EXPECT_EQ(changes.added, std::vector{after[3].id});
}

TEST(MemberPlaces, SeedsCountBeforePlaces) {
  ObjectMembers before = objectAt("before", {{0, 0, 0}, {1, 0, 0}});
  ObjectMembers moved = objectAt("moved", {{5, 0, 0}, {6, 0, 0}});
  moved.seeds = before.seeds;
  const ObjectMembers there = objectAt("there", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  const std::vector<ObjectMembers> after{moved, there};
  const auto successors = successorsOf({&before}, listOf(after));
  ASSERT_EQ(successors.front().size(), 2U);
  EXPECT_EQ(successors.front()[0].other, 0U) << "by its seeds";
  before.places.clear();
  EXPECT_EQ(successorsOf({&before}, listOf(after)).front().size(), 1U) << "without places by its seeds alone";
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
  std::vector<std::vector<std::size_t>> shared(some.size(), std::vector<std::size_t>(others.size(), 0));
  for (std::size_t object = 0; object < some.size(); ++object)
    for (std::size_t member = 0; member < some[object].seeds.size(); ++member) {
      std::optional<std::size_t> owner;
      double nearest = 36;  // 0.3 m in steps of 5 cm, squared
      for (std::size_t other = 0; other < others.size() && !owner; ++other)
        if (std::count(others[other].seeds.begin(), others[other].seeds.end(), some[object].seeds[member]) > 0)
          owner = other;
      if (!owner && some[object].placeOf(member) != kNoMemberPlace)
        for (std::size_t other = 0; other < others.size(); ++other)
          for (const MemberPlace place : others[other].places) {
            const double distance = (decoded(place) - decoded(some[object].placeOf(member))).squaredNorm();
            const bool is_better =
                distance < nearest || (distance == nearest && owner && others[other].id < others[*owner].id);
            if (place != kNoMemberPlace && distance <= 36 && (is_better || !owner)) owner = other, nearest = distance;
          }
      if (owner) ++shared[object][*owner];
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
    const auto shared = sharedBySeedOrPlace(listOf(some), listOf(others));
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
