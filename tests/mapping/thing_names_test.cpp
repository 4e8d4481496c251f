// SPDX-License-Identifier: Apache-2.0
// Things keep their names while the objects behind them gain and lose members, split and join.
#include <gtest/gtest.h>

#include "mapping/change/map_things.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

ContentHash hashOf(const std::string& name) {
  return ContentHasher().addText(name).finish();
}
ObjectMembers thingMembers(const std::string& name, std::vector<std::uint64_t> seeds) {
  return {hashOf(name), "Tree", std::move(seeds)};
}

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

TEST_F(ThingNames, ComeBackWithTheSameObjectOnly) {
  change({thingMembers("here", {1, 2}), thingMembers("other", {9})});
  change({thingMembers("other", {9})});
  EXPECT_FALSE(found(hashOf("here").hex()));
  change({thingMembers("here", {1, 2}), thingMembers("other", {9})});
  EXPECT_EQ(nameOfObject("here"), rdf::iriOfThing(hashOf("here")));
  EXPECT_EQ(found(hashOf("here").hex())->object, hashOf("here"));
}

TEST_F(ThingNames, AreNeverGivenTwice) {
  change({thingMembers("first", {1, 2, 3, 4})});
  change({thingMembers("grown", {1, 2, 3, 4, 5, 6, 7, 8, 9})});
  // The former object comes back beside what has taken its name.
  change({thingMembers("first", {1, 2, 3, 4}), thingMembers("rest", {5, 6, 7, 8, 9})});
  EXPECT_EQ(nameOfObject("rest"), rdf::iriOfThing(hashOf("first"))) << "it shares most";
  EXPECT_NE(nameOfObject("first"), rdf::iriOfThing(hashOf("first")));
}

}  // namespace
}  // namespace cluxel::mapping
