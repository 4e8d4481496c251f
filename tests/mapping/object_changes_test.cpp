// SPDX-License-Identifier: Apache-2.0
// What became of objects: by hand, and the two ways to compare against each other.
#include "mapping/change/object_changes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

ContentHash idNamed(const std::string& name) {
  return ContentHasher().addText(name).finish();
}

ObjectMembers decided(const std::string& name, double confidence) {
  ObjectMembers object{idNamed(name), "Tree", {1, 2}};
  object.confidence = confidence;
  return object;
}

TEST(ObjectChanges, RoundingIsNoOtherConfidence) {
  const ObjectMembers some = decided("tree", 0.5);
  ObjectMembers other_parts = decided("tree", 0.5 + 1e-12);
  EXPECT_TRUE(some.isDecidedAs(other_parts));
  other_parts.parts = 7;
  EXPECT_FALSE(some.isDecidedAs(other_parts));
  EXPECT_FALSE(some.hasOtherConfidence(other_parts)) << "only its parts differ";
  EXPECT_TRUE(some.hasOtherConfidence(decided("tree", 0.51)));
}

TEST(ObjectChanges, TellWhatIsDecidedOtherwise) {
  const std::string trunk = "clx:TreeTrunk", top = "clx:TreeTop";
  ObjectMembers swapped = decided("swapped", 0.9), was_swapped = swapped, other_order = decided("order", 0.9),
                order = other_order;
  swapped.addToPart(partKey(trunk), 1), swapped.addToPart(partKey(top), 2);
  was_swapped.addToPart(partKey(top), 1), was_swapped.addToPart(partKey(trunk), 2);
  order.addToPart(partKey(top), 1), order.addToPart(partKey(trunk), 2);
  other_order.addToPart(partKey(trunk), 2), other_order.addToPart(partKey(top), 1);
  std::vector<ObjectMembers> before{decided("same", 0.5), decided("surer", 0.5), decided("gone", 0.5), was_swapped,
                                    order};
  std::vector<ObjectMembers> after{decided("same", 0.5), decided("surer", 0.6), decided("new", 0.5), swapped,
                                   other_order};
  const auto byId = [](const ObjectMembers& a, const ObjectMembers& b) { return a.id < b.id; };
  std::sort(before.begin(), before.end(), byId), std::sort(after.begin(), after.end(), byId);
  const DifferentObjects different = differenceOf(before, after);
  ASSERT_EQ(different.before.size(), 1U);
  EXPECT_EQ(different.before.front().id, idNamed("gone"));
  ASSERT_EQ(different.after.size(), 1U);
  EXPECT_EQ(different.after.front().id, idNamed("new"));
  std::vector<ContentHash> redecided;
  for (const RedecidedObject& object : different.redecided) redecided.push_back(object.after.id);
  std::vector<ContentHash> expected{idNamed("surer"), idNamed("swapped")};
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(redecided, expected);
}

TEST(ObjectChanges, OfSeveralChangesCompareTheFirstWithTheLast) {
  ObjectDifference difference;
  difference.add(
      {{}, {}, {{decided("back", 0.5), decided("back", 0.6)}, {decided("goes", 0.5), decided("goes", 0.6)}}});
  difference.add({{decided("leaves", 0.5)}, {decided("new", 0.5)}, {{decided("back", 0.6), decided("back", 0.5)}}});
  difference.add({{decided("goes", 0.6)}, {decided("leaves", 0.7)}, {{decided("new", 0.5), decided("new", 0.8)}}});
  const DifferentObjects all = std::move(difference).take();
  ASSERT_EQ(all.before.size(), 1U);
  EXPECT_EQ(all.before.front().id, idNamed("goes"));
  EXPECT_EQ(all.before.front().confidence, 0.5);
  ASSERT_EQ(all.after.size(), 1U);
  EXPECT_EQ(all.after.front().id, idNamed("new"));
  EXPECT_EQ(all.after.front().confidence, 0.8);
  ASSERT_EQ(all.redecided.size(), 1U) << "that which came back otherwise";
  EXPECT_EQ(all.redecided.front().after.id, idNamed("leaves"));
  EXPECT_EQ(all.redecided.front().before.confidence, 0.5);
  EXPECT_EQ(all.redecided.front().after.confidence, 0.7);
}

TEST(ObjectChanges, TellAddedGoneChangedSplitAndJoined) {
  const auto object = [](const std::string& name, std::vector<std::uint64_t> seeds) {
    return ObjectMembers{idNamed(name), "Tree", std::move(seeds)};
  };
  const std::vector<ObjectMembers> before{object("same", {1, 2, 3}),    object("grows", {10, 11}),
                                          object("vanishes", {20, 21}), object("two", {30, 31, 32, 33}),
                                          object("left", {40, 41}),     object("right", {50, 51})};
  const std::vector<ObjectMembers> after{object("same", {1, 2, 3}), object("grown", {10, 11, 12, 13, 14, 15}),
                                         object("new", {60}),       object("half1", {30, 31}),
                                         object("half2", {32, 33}), object("one", {40, 41, 50, 51})};
  const ObjectChanges changes = compareObjects(before, after);
  EXPECT_EQ(changes.unchanged, 1U);
  EXPECT_EQ(changes.added, std::vector{idNamed("new")});
  EXPECT_EQ(changes.gone, std::vector{idNamed("vanishes")});
  ASSERT_EQ(changes.changed.size(), 1U);
  EXPECT_EQ(changes.changed.front().id, idNamed("grown"));
  EXPECT_EQ(changes.changed.front().from, std::vector{idNamed("grows")});
  EXPECT_EQ(changes.split.size(), 2U);
  ASSERT_EQ(changes.joined.size(), 1U);
  EXPECT_EQ(changes.joined.front().from.size(), 2U);
}

TEST(ObjectChanges, OfAMergeTellWhatHasJoinedAnObjectOfTheSameName) {
  const ObjectMembers piece{idNamed("piece"), "Tree", {1, 2}}, whole{idNamed("whole"), "Tree", {1, 2, 3, 4}};
  const ObjectChanges changes = compareObjects({piece, whole}, {whole});
  EXPECT_EQ(changes.unchanged, 0U);
  EXPECT_TRUE(changes.gone.empty());
  ASSERT_EQ(changes.joined.size(), 1U);
  EXPECT_EQ(changes.joined.front().id, whole.id);
  EXPECT_EQ(changes.joined.front().from.size(), 2U) << "the piece was not mentioned";
}

TEST(ObjectChanges, OfAMergeWhatBecomesPartOfTheGroundIsGone) {
  const ContentHash of_class = rules::idOfClassWide("Ground");
  const ObjectMembers ground{of_class, "Ground", {1, 2, 3, 4}}, more_ground{of_class, "Ground", {1, 2, 3, 7}};
  const ObjectMembers bush{idNamed("bush"), "Bush", {7}}, other_bush{idNamed("other bush"), "Bush", {4}};
  const ObjectChanges changes = compareObjects({bush, ground}, {more_ground, other_bush});
  EXPECT_EQ(changes.unchanged, 1U) << "the ground";
  EXPECT_EQ(changes.gone, std::vector{bush.id});
  EXPECT_EQ(changes.added, std::vector{other_bush.id}) << "it is no piece of the ground";
  EXPECT_TRUE(changes.changed.empty() && changes.split.empty() && changes.joined.empty());
}

TEST(ObjectChanges, OfTwoStatesOfOneMapNeedOnlyWhatDiffers) {
  std::mt19937 random(4);
  const auto stateOf = [&](std::vector<std::uint64_t> seeds) {
    std::shuffle(seeds.begin(), seeds.end(), random);
    std::vector<ObjectMembers> objects;
    for (std::size_t first = 0; first < seeds.size();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 6, seeds.size() - first);
      ObjectMembers object{{},
                           "Tree",
                           {seeds.begin() + static_cast<std::ptrdiff_t>(first),
                            seeds.begin() + static_cast<std::ptrdiff_t>(first + count)}};
      std::sort(object.seeds.begin(), object.seeds.end());
      ContentHasher hasher;
      for (const std::uint64_t seed : object.seeds) hasher.add(seed);
      object.id = hasher.finish();
      objects.push_back(std::move(object));
      first += count;
    }
    return objects;
  };
  const auto sorted = [](std::vector<ObjectMembers> objects) {
    std::sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return objects;
  };
  for (int round = 0; round < 50; ++round) {
    std::vector<std::uint64_t> few(30), fewer(20), same(40);
    std::iota(few.begin(), few.end(), 1U), std::iota(fewer.begin(), fewer.end(), 5U),
        std::iota(same.begin(), same.end(), 100U);
    std::vector<ObjectMembers> before = stateOf(few), after = stateOf(fewer);
    for (const ObjectMembers& object : stateOf(same)) before.push_back(object), after.push_back(object);
    before = sorted(before), after = sorted(after);
    const ObjectChanges expected = compareObjects(before, after), found = compareStates(before, after);
    const auto listed = [](const std::vector<DerivedObject>& objects) {
      std::vector<std::pair<ContentHash, std::vector<ContentHash>>> list;
      for (const DerivedObject& object : objects) list.emplace_back(object.id, object.from);
      return list;
    };
    EXPECT_GE(found.unchanged, 7U);
    EXPECT_EQ(found.unchanged, expected.unchanged);
    EXPECT_EQ(found.added, expected.added);
    EXPECT_EQ(found.gone, expected.gone);
    EXPECT_EQ(listed(found.changed), listed(expected.changed));
    EXPECT_EQ(listed(found.split), listed(expected.split));
    EXPECT_EQ(listed(found.joined), listed(expected.joined));
  }
}

}  // namespace
}  // namespace cluxel::mapping
