// SPDX-License-Identifier: Apache-2.0
// Things keep their names while the objects behind them gain and lose members, split and join.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <random>
#include <set>

#include "mapping/change/map_things.hpp"
#include "mapping/change/member_places.hpp"
#include "mapping/random_objects.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/things/ended_names.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

/// The names after a series of states of a map's objects.
class ThingNames : public testing::Test {
 protected:
  void change(const std::vector<ObjectMembers>& after) {
    WriteTransaction transaction = environment->write();
    writeThings(transaction, "2026-01-0" + std::to_string(++day) + "T00:00:00.000000Z", present, after);
    transaction.commit();
    present = after;
  }
  std::string nameOfObject(const std::string& object) const {
    return thingOf(storedThings(QuadReader(environment->read())), hashOf(object)).iri;
  }
  std::optional<FormerName> found(const std::string& name) const {
    std::vector<ContentHash> ids;
    for (const ObjectMembers& object : present) ids.push_back(object.id);
    return Lineage(QuadReader(environment->read()), ids).find(name);
  }
  std::optional<EndedName> ended(const std::string& name) const {
    const auto isPresent = [&](const ContentHash& id) {
      return std::any_of(present.begin(), present.end(), [&](const ObjectMembers& object) { return object.id == id; });
    };
    return endOf(QuadReader(environment->read()), isPresent, name);
  }

  ScratchFolder folder;
  std::shared_ptr<Environment> environment = Environment::open(folder.path() / "store.clx", OpenMode::Create);
  std::vector<ObjectMembers> present;
  int day = 0;
};

TEST_F(ThingNames, StayWhenAnObjectGainsAndLosesMembers) {
  change({thingMembers("small", {1, 2})});
  change({thingMembers("grown", {1, 2, 3})});
  EXPECT_EQ(nameOfObject("grown"), rdf::iriOfThing(hashOf("small")));
  const auto former = found("object/" + hashOf("small").hex());
  ASSERT_TRUE(former);
  EXPECT_EQ(former->object, hashOf("grown"));
  EXPECT_EQ(found(rdf::iriOfObject(hashOf("small")))->object, hashOf("grown"));
  EXPECT_EQ(found(rdf::iriOfThing(hashOf("small")))->object, hashOf("grown"));
  EXPECT_FALSE(found(rdf::iriOfObject(hashOf("unknown"))));
  change({thingMembers("small", {1, 2})});
  EXPECT_EQ(nameOfObject("small"), rdf::iriOfThing(hashOf("small")));
}

TEST_F(ThingNames, StayWithTheLargerPartOfASplit) {
  change({thingMembers("both", {1, 2, 3, 4, 5})});
  change({thingMembers("two", {4, 5}), thingMembers("three", {1, 2, 3})});
  EXPECT_EQ(nameOfObject("three"), rdf::iriOfThing(hashOf("both")));
  EXPECT_EQ(nameOfObject("two"), rdf::iriOfThing(hashOf("two")));
  EXPECT_EQ(found(hashOf("both").hex())->object, hashOf("three"));
  change({thingMembers("two", {4, 5})});
  EXPECT_EQ(found(hashOf("both").hex())->object, hashOf("two")) << "by descent, when the rest is gone";
}

TEST_F(ThingNames, OfAJoinAreTheOlderOnes) {
  change({thingMembers("old", {1, 2})});
  change({thingMembers("old", {1, 2}), thingMembers("young", {3, 4, 5})});
  change({thingMembers("joined", {1, 2, 3, 4, 5})});
  EXPECT_EQ(nameOfObject("joined"), rdf::iriOfThing(hashOf("old")));
  EXPECT_EQ(found("thing/" + hashOf("young").hex())->object, hashOf("joined"));
}

TEST_F(ThingNames, OfEquallyOldOnesTheLargestGoesOn) {
  for (const bool large_first : {true, false}) {
    const std::string large = hashOf("x") < hashOf("y") ? "x" : "y", small = large == "x" ? "y" : "x";
    change({thingMembers(large_first ? large : small, {1, 2, 3, 4, 5}),
            thingMembers(large_first ? small : large, {6, 7})});
    change({thingMembers("joined" + std::to_string(static_cast<int>(large_first)), {1, 2, 3, 4, 5, 6, 7})});
    EXPECT_EQ(nameOfObject("joined" + std::to_string(static_cast<int>(large_first))),
              rdf::iriOfThing(hashOf(large_first ? large : small)));
    change({});
  }
}

TEST_F(ThingNames, ComeBackWithTheSameObjectOnly) {
  change({thingMembers("here", {1, 2}), thingMembers("other", {9})});
  change({thingMembers("other", {9})});
  EXPECT_FALSE(found(hashOf("here").hex()));
  change({thingMembers("here", {1, 2}), thingMembers("other", {9})});
  EXPECT_EQ(nameOfObject("here"), rdf::iriOfThing(hashOf("here")));
  EXPECT_EQ(found(hashOf("here").hex())->object, hashOf("here"));
}

TEST_F(ThingNames, OfWhatEndedTellWhenAndWhatItLedTo) {
  change({thingMembers("young", {1, 2}), thingMembers("other", {9})});
  change({thingMembers("grown", {1, 2, 3}), thingMembers("other", {9})});
  EXPECT_FALSE(ended("object/" + hashOf("young").hex())) << "it is there under another name";
  change({thingMembers("other", {9})});
  for (const std::string& name : {rdf::iriOfObject(hashOf("young")), rdf::iriOfObject(hashOf("grown")),
                                  rdf::iriOfThing(hashOf("young")), hashOf("young").hex().substr(0, 8)}) {
    const auto end = ended(name);
    ASSERT_TRUE(end) << name;
    EXPECT_EQ(end->time, "2026-01-03T00:00:00.000000Z");
    EXPECT_TRUE(end->later.empty());
    EXPECT_FALSE(end->went_on);
  }
  EXPECT_EQ(textOf(*ended(rdf::iriOfObject(hashOf("young")))),
            "object/" + hashOf("young").hex() +
                " ended at 2026-01-03T00:00:00.000000Z, and nothing that there is continues it");
  EXPECT_FALSE(ended(rdf::iriOfObject(hashOf("unknown"))));
  EXPECT_FALSE(ended(rdf::iriOfObject(hashOf("other"))));
}

TEST_F(ThingNames, OfWhatBecameSeveralTellThem) {
  change({thingMembers("whole", {1, 2, 3, 4, 5, 6})});
  change({thingMembers("a", {1, 2, 3}), thingMembers("b", {4, 5}), thingMembers("c", {6})});
  change({thingMembers("b", {4, 5}), thingMembers("c", {6})});
  const auto end = ended(rdf::iriOfObject(hashOf("whole")));
  ASSERT_TRUE(end);
  std::vector<ContentHash> expected{hashOf("b"), hashOf("c")};
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(end->later, expected);
  EXPECT_EQ(textOf(*end), "object/" + hashOf("whole").hex() + " went on as 2 objects: object/" + expected[0].hex() +
                              ", object/" + expected[1].hex());
}

TEST_F(ThingNames, AreNeverGivenTwice) {
  change({thingMembers("first", {1, 2, 3, 4})});
  change({thingMembers("grown", {1, 2, 3, 4, 5, 6, 7, 8, 9})});
  // The former object comes back beside what has taken its name.
  change({thingMembers("first", {1, 2, 3, 4}), thingMembers("rest", {5, 6, 7, 8, 9})});
  EXPECT_EQ(nameOfObject("rest"), rdf::iriOfThing(hashOf("first"))) << "it shares most";
  EXPECT_NE(nameOfObject("first"), rdf::iriOfThing(hashOf("first")));
}

TEST_F(ThingNames, ComeBackToThoseThatHadThemWhenAJoinIsUndone) {
  change({thingMembers("old", {1, 2, 3, 4})});
  change({thingMembers("old", {1, 2, 3, 4}), thingMembers("young", {11, 12, 13})});
  change({thingMembers("joined", {1, 2, 11, 12, 13})});
  EXPECT_EQ(nameOfObject("joined"), rdf::iriOfThing(hashOf("old")));
  change({thingMembers("old", {1, 2, 3, 4}), thingMembers("young", {11, 12, 13})});
  EXPECT_EQ(nameOfObject("old"), rdf::iriOfThing(hashOf("old")));
  EXPECT_EQ(nameOfObject("young"), rdf::iriOfThing(hashOf("young"))) << "though it shares most with what was joined";
}

TEST_F(ThingNames, LeadToWhatContinuesThemThoughMoreWasDerivedFromThem) {
  change({thingMembers("old", {20, 21})});
  change({thingMembers("old", {20, 21}), thingMembers("whole", {1, 2, 3, 4, 5})});
  change({thingMembers("old", {20, 21}), thingMembers("two", {4, 5}), thingMembers("three", {1, 2, 3})});
  change({thingMembers("two", {4, 5}), thingMembers("joined", {1, 2, 3, 20, 21})});
  ASSERT_TRUE(found(rdf::iriOfThing(hashOf("whole")))) << "the two were derived from it, too";
  EXPECT_EQ(found(rdf::iriOfThing(hashOf("whole")))->object, hashOf("joined"));
  EXPECT_EQ(found("object/" + hashOf("whole").hex())->object, hashOf("joined"));
  change({thingMembers("old", {20, 21}), thingMembers("two", {4, 5}), thingMembers("three", {1, 2, 3})});
  EXPECT_EQ(found(rdf::iriOfThing(hashOf("whole")))->object, hashOf("three"));
  EXPECT_EQ(found(rdf::iriOfThing(hashOf("old")))->object, hashOf("old"));
}

TEST_F(ThingNames, EndOnce) {
  change({thingMembers("old", {1, 2}), thingMembers("young", {3, 4, 5})});
  change({thingMembers("joined", {1, 2, 3, 4, 5})});
  change({});
  change({thingMembers("joined", {1, 2, 3, 4, 5})});
  change({});
  std::map<std::string, int> ends;
  forEachHistoryLink(QuadReader(environment->read()), "invalidatedAtTime",
                     [&](const Term& thing, const Term&) { ++ends[thing.text]; });
  EXPECT_EQ(ends.size(), 2U);
  for (const auto& [thing, times] : ends) EXPECT_EQ(times, 1) << thing;
}

TEST_F(ThingNames, OfWhatIsJoinedByPlaceLeadToTheJoin) {
  const auto at = [](const std::string& name, std::vector<std::uint64_t> seeds, const std::vector<double>& x_m) {
    ObjectMembers object = thingMembers(name, std::move(seeds));
    for (const double x : x_m) object.places.push_back(placeOf({x, 0, 0}));
    return object;
  };
  change({at("first", {1, 2, 3}, {0, 1, 2}), at("second", {11, 12}, {5, 6})});
  change({at("joined", {1, 2, 3, 21, 22}, {0, 1, 2, 5, 6})});
  EXPECT_EQ(nameOfObject("joined"), rdf::iriOfThing(hashOf("first")));
  ASSERT_TRUE(found("object/" + hashOf("second").hex())) << "its seeds are gone; its name was lost";
  EXPECT_EQ(found("object/" + hashOf("second").hex())->object, hashOf("joined"));
}

std::vector<ObjectMembers> without(const std::vector<ObjectMembers>& objects, const std::set<ContentHash>& same) {
  std::vector<ObjectMembers> others;
  std::copy_if(objects.begin(), objects.end(), std::back_inserter(others),
               [&](const ObjectMembers& object) { return !same.contains(object.id); });
  return others;
}

TEST(ThingNamesOfSomeObjects, AreThoseOfAllObjects) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    const auto of_all = Environment::temporary(), of_some = Environment::temporary();
    WriteTransaction all = of_all->write(), some = of_some->write();
    RandomObjects world;
    std::vector<ObjectMembers> before;
    std::size_t given = 0, present = 0;
    for (int round = 0; round < 60; ++round) {
      world.change(random);
      const std::vector<ObjectMembers> after = world.objects();
      std::set<ContentHash> old, same;
      for (const ObjectMembers& object : before) old.insert(object.id);
      for (const ObjectMembers& object : after)
        if (old.contains(object.id)) same.insert(object.id);
      const std::string time = "2026-01-01T00:00:" + std::to_string(10 + round) + ".000000Z";
      writeThings(all, time, before, after);
      const auto changed_before = without(before, same), changed_after = without(after, same);
      writeThings(some, time, changed_before, changed_after,
                  [&](const ContentHash& object) { return same.contains(object); });
      ASSERT_EQ(historyOf(all), historyOf(some)) << "seed " << seed << ", round " << round;
      const ObjectChanges expected = compareStates(before, after);
      const ObjectChanges found = compareStates(changed_before, changed_after, same.size());
      EXPECT_EQ(found.unchanged, expected.unchanged);
      EXPECT_EQ(found.added, expected.added);
      EXPECT_EQ(found.gone, expected.gone);
      EXPECT_EQ(found.changed.size() + found.split.size() + found.joined.size(),
                expected.changed.size() + expected.split.size() + expected.joined.size());
      given += changed_after.size(), present += after.size();
      before = after;
    }
    EXPECT_LT(given, present);
  }
}

TEST(ThingNamesOfSomeObjects, AreAsBeforeWhenAChangeIsUndone) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    const auto environment = Environment::temporary();
    WriteTransaction transaction = environment->write();
    RandomObjects world;
    std::vector<ObjectMembers> before;
    int second = 10'000;
    const auto write = [&](const std::vector<ObjectMembers>& from, const std::vector<ObjectMembers>& to) {
      writeThings(transaction, "2026-01-01T0" + std::to_string(++second) + ".000000Z", from, to);
    };
    for (int round = 0; round < 60; ++round) {
      world.change(random);
      const std::vector<ObjectMembers> after = world.objects();
      const auto names = namesOf(before, transaction);
      write(before, after);
      const auto names_after = namesOf(after, transaction);
      write(after, before);
      EXPECT_EQ(namesOf(before, transaction), names) << "seed " << seed << ", round " << round;
      write(before, after);
      ASSERT_EQ(namesOf(after, transaction), names_after) << "seed " << seed << ", round " << round;
      std::set<std::string> held;
      for (const auto& [object, name] : names_after) EXPECT_TRUE(held.insert(name).second) << "two objects, one name";
      std::set<std::string> ended;
      forEachHistoryLink(QuadReader(transaction), "invalidatedAtTime", [&](const Term& thing, const Term&) {
        EXPECT_TRUE(ended.insert(thing.text).second) << "ended twice";
        EXPECT_FALSE(held.contains(thing.text)) << "ended, and there";
      });
      before = after;
    }
  }
}

}  // namespace
}  // namespace cluxel::mapping
