// SPDX-License-Identifier: Apache-2.0
// Names of merged maps: what is in one of them keeps its name, and each name leads on once.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <sstream>

#include "mapping/change/member_places.hpp"
#include "mapping/living_map.hpp"
#include "rdf/map_iris.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {
namespace {

/// An object with one name in all maps that have it keeps it, unless it is the only name of another object, too.
void expectNamesKept(const std::vector<const LivingMap*>& maps, const LivingMap& result) {
  std::vector<NamesOfMap> of_maps;
  for (const LivingMap* map : maps) of_maps.push_back(map->names());
  const auto names = namesIn(of_maps).of_object;
  const NamesOfMap after = result.names();
  std::map<std::string, int> wanted;
  for (const auto& [object, name] : after.thing_of)
    if (const auto known = names.find(object); known != names.end() && known->second.size() == 1)
      ++wanted[*known->second.begin()];
  for (const auto& [object, name] : after.thing_of) {
    const auto known = names.find(object);
    if (known == names.end()) continue;
    if (known->second.size() > 1 || wanted.at(*known->second.begin()) > 1) continue;
    EXPECT_EQ(name, *known->second.begin());
  }
}

std::set<std::string> linesOf(const std::string& text) {
  std::set<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.insert(line);
  return lines;
}

/// The history is that of `map`; in addition, names that had ended for nothing lead on. Returns how many.
std::size_t expectHistoryOf(const LivingMap& map, const LivingMap& result) {
  const std::set<std::string> before = linesOf(map.history()), after = linesOf(result.history());
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));
  const QuadReader quads(map.environment->read()), quads_after(result.environment->read());
  const ThingLookup known(quads), lookup(quads_after);
  std::set<std::string> added;
  for (const auto& [thing, since] : timesOfThings(quads)) {
    const std::vector<Term> heirs = lookup.replacementsOf(thing);
    if (known.endsOf(thing).empty() || !known.replacementsOf(thing).empty() || heirs.empty()) continue;
    EXPECT_EQ(heirs.size(), 1U);
    EXPECT_TRUE(lookup.endsOf(heirs.front().text).empty()) << "leads to what is there";
    const auto line = [](const std::string& s, const std::string& p, const std::string& o) {
      return "<" + s + "> <" + p + "> <" + o + "> <" + std::string(rdf::vocabulary::kGraphHistory) + "> .";
    };
    added.insert(line(thing, isReplacedBy(), heirs.front().text));
    added.insert(line(heirs.front().text, provenance("wasDerivedFrom"), thing));
  }
  for (const std::string& line : after) EXPECT_TRUE(before.contains(line) || added.contains(line)) << line;
  return added.size() / 2;
}

TEST(MergedNames, StayWhereAMapIsMergedWithItselfOrWithWhatItWas) {
  std::size_t lead_on = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    RandomObjects world;
    LivingMap map;
    std::vector<std::unique_ptr<LivingMap>> earlier;
    for (int round = 0; round < 24; ++round) {
      world.change(random);
      map.change(world.objects(), timeOf(10'000 + round));
      if (round % 6 == 3) earlier.push_back(std::make_unique<LivingMap>(map));
    }
    const LivingMap copy(map);
    std::vector<std::vector<const LivingMap*>> merges{{&map, &copy}};
    for (const auto& old : earlier) {
      merges.push_back({&map, old.get()});
      merges.push_back({old.get(), &map});
      merges.push_back({old.get(), &map, earlier.front().get(), &copy});
    }
    for (const auto& maps : merges) {
      const LivingMap result = merged(maps, map.present, timeOf(20'000));
      ASSERT_EQ(result.names().thing_of, map.names().thing_of) << "seed " << seed;
      lead_on += expectHistoryOf(map, result);
      expectSoundNames(result);
      std::vector<const LivingMap*> again = maps;
      again.push_back(&result);
      ASSERT_EQ(merged(again, map.present, timeOf(30'000)).history(), result.history()) << "merged again";
    }
  }
  EXPECT_GT(lead_on, 0U);
}

TEST(MergedNames, OfMapsThatWentDifferentWaysAreSoundAndComeToRest) {
  std::size_t several = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    RandomObjects world_a;
    LivingMap a;
    int second = 10'000;
    const auto live = [&](LivingMap& map, RandomObjects& world, int rounds) {
      for (int round = 0; round < rounds; ++round) {
        world.change(random);
        map.change(world.objects(), timeOf(++second));
      }
    };
    live(a, world_a, 6);
    RandomObjects world_b = world_a;
    LivingMap b(a);
    live(a, world_a, static_cast<int>(1 + random() % 8));
    live(b, world_b, static_cast<int>(1 + random() % 8));
    if (seed % 3 == 0) {  // both come to the same objects
      RandomObjects same = world_b;
      same.change(random);
      a.change(same.objects(), timeOf(++second)), b.change(same.objects(), timeOf(++second));
      world_a = same;
    }
    if (seed % 2 == 0) world_a.change(random);
    const std::vector<ObjectMembers> after = world_a.objects();
    const LivingMap result = merged({&a, &b}, after, timeOf(20'000));
    SCOPED_TRACE("seed " + std::to_string(seed));
    expectSoundNames(result);
    expectNamesKept({&a, &b}, result);
    ASSERT_EQ(merged({&b, &a}, after, timeOf(20'000)).history(), result.history()) << "the order of the maps counts";
    for (const auto& maps : {std::vector<const LivingMap*>{&result, &a}, {&b, &result}, {&a, &b, &result}})
      ASSERT_EQ(merged(maps, after, timeOf(30'000)).history(), result.history()) << "merged again";
    for (const auto& [object, names] : namesIn({a.names(), b.names()}).of_object) several += names.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(several, 10U) << "the maps named few objects differently";
}

TEST(MergedNames, TheOldestStaysAndEachObjectKeepsOneWhereItCan) {
  const std::vector<ObjectMembers> objects{thingMembers("a", {1}), thingMembers("b", {2, 3}), thingMembers("c", {4})};
  const Thing first{"first", "2026-01-01"}, second{"second", "2026-01-02"}, third{"third", "2026-01-03"};
  const auto kept = [&](const std::vector<std::vector<Thing>>& names) {
    std::map<ContentHash, std::vector<Thing>> of_objects;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (!names[i].empty()) of_objects[objects[i].id] = names[i];
    std::vector<std::string> all;
    for (const std::optional<Thing>& name : keptNames(objects, of_objects)) all.push_back(name ? name->iri : "");
    return all;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(kept({{first, second}, {third}, {}}), (Names{"first", "third", ""}));
  EXPECT_EQ(kept({{first, second}, {first, third}, {}}), (Names{"second", "first", ""})) << "b has more members";
  EXPECT_EQ(kept({{first, second}, {second, third}, {first}}), (Names{"second", "third", "first"}));
  EXPECT_EQ(kept({{first}, {first}, {first}}), (Names{"", "first", ""}));
}

TEST(MergedNames, ALargeThingGoesOnInItsBodyNotInAScrap) {
  std::uint64_t next = 100;
  const auto at = [&](const std::string& name, double begin_m, double end_m) {
    ObjectMembers object = thingMembers(name, {});
    for (double x = begin_m; x < end_m; ++x)
      object.seeds.push_back(next++), object.places.push_back(placeOf({x, 0, 0}));
    return object;
  };
  LivingMap one, other;
  const ObjectMembers whole = at("whole", 0, 12), of_other = at("of other", 4, 6);
  one.change({whole}, timeOf(10'001));
  other.change({of_other}, timeOf(10'002));
  ObjectMembers scrap = at("scrap", 0, 2), body = at("body", 2, 12);
  std::copy_n(whole.seeds.begin(), 2, scrap.seeds.begin());
  std::copy_n(of_other.seeds.begin(), 2, body.seeds.begin() + 2);
  const LivingMap result = merged({&other, &one}, {scrap, body}, timeOf(20'000));
  const NamesOfMap names = result.names();
  EXPECT_EQ(names.thing_of.at(body.id), rdf::iriOfThing(whole.id)) << "the older name of the two";
  EXPECT_EQ(names.thing_of.at(scrap.id), rdf::iriOfThing(scrap.id));
  const QuadReader quads(result.environment->read());
  const Lineage lineage(quads, {scrap.id, body.id});
  for (const std::string& name : {rdf::iriOfObject(whole.id), rdf::iriOfObject(of_other.id)}) {
    ASSERT_TRUE(lineage.find(name));
    EXPECT_EQ(lineage.find(name)->object, body.id);
  }
}

/// The ground of one map covers what another took for a bush.
TEST(MergedNames, OfWhatBecomesPartOfTheGroundEndForNothing) {
  const auto ground = [](std::vector<std::uint64_t> seeds) {
    return ObjectMembers{rules::idOfClassWide("Ground"), "Ground", std::move(seeds)};
  };
  LivingMap a, b;
  const ObjectMembers bush = thingMembers("bush", {11, 12});
  a.change({bush, ground({1, 2, 3})}, timeOf(10'001));
  b.change({ground({4, 5})}, timeOf(10'002));
  const std::vector<ObjectMembers> after{ground({1, 2, 3, 4, 5, 11, 12})};
  for (const auto& maps : {std::vector<const LivingMap*>{&a, &b}, {&b, &a}}) {
    const LivingMap result = merged(maps, after, timeOf(20'000));
    expectSoundNames(result);
    const QuadReader quads(result.environment->read());
    EXPECT_TRUE(ThingLookup(quads).replacementsOf(rdf::iriOfThing(bush.id)).empty());
    const Lineage lineage(quads, {after.front().id});
    for (const std::string& name : {rdf::iriOfObject(bush.id), rdf::iriOfThing(bush.id)})
      EXPECT_FALSE(lineage.find(name)) << "what is said of the bush would be said of the ground";
  }
}

TEST(MergedNames, WhatEndedInTwoMapsIsReplacedOnce) {
  LivingMap a;
  const ObjectMembers lost = thingMembers("lost", {1, 2}), x = thingMembers("x", {11, 12, 13}),
                      y = thingMembers("y", {21, 22, 23});
  a.change({x, y}, timeOf(10'001));
  a.change({x, y, lost}, timeOf(10'002));
  LivingMap b(a);
  a.change({thingMembers("x and lost", {1, 2, 11, 12, 13}), y}, timeOf(10'003));
  b.change({x, thingMembers("y and lost", {1, 2, 21, 22, 23})}, timeOf(10'004));
  a.change({y}, timeOf(10'005));
  const std::vector<ObjectMembers> after{y};
  for (const auto& maps : {std::vector<const LivingMap*>{&a, &b}, {&b, &a}}) {
    const LivingMap result = merged(maps, after, timeOf(20'000));
    expectSoundNames(result);
    const std::vector<Term> heirs =
        ThingLookup(QuadReader(result.environment->read())).replacementsOf(rdf::iriOfThing(lost.id));
    ASSERT_EQ(heirs.size(), 1U);
    EXPECT_EQ(heirs.front().text, rdf::iriOfThing(y.id)) << "the one that has an object";
  }
}

}  // namespace
}  // namespace cluxel::mapping
