// SPDX-License-Identifier: Apache-2.0
// Maps of objects by hand, and merges of them, to look at names alone.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "mapping/change/map_things.hpp"
#include "mapping/random_objects.hpp"

namespace cluxel::mapping {

/// A map of which only the objects and the history are there.
class LivingMap {
 public:
  LivingMap() = default;
  LivingMap(const LivingMap& other) : present(other.present), activities(other.activities) {
    WriteTransaction transaction = environment->write();
    rdf::QuadWriter writer(transaction);
    const QuadReader quads(other.environment->read());
    rdf::QuadCursor cursor = quads.scan({.s = {}, .p = {}, .o = {}, .g = {}});
    for (rdf::QuadIds quad; cursor.next(quad);)
      writer.add({quads.termOf(quad.s), quads.termOf(quad.p), quads.termOf(quad.o), quads.termOf(quad.g)});
    writer.flush();
    transaction.commit();
  }
  LivingMap& operator=(const LivingMap&) = delete;

  void change(const std::vector<ObjectMembers>& after, const std::string& time) {
    WriteTransaction transaction = environment->write();
    writeThings(transaction, time, present, after);
    transaction.commit();
    present = after;
    activities.insert(time + std::to_string(++runs_));
  }

  NamesOfMap names() const {
    std::vector<ContentHash> ids;
    for (const ObjectMembers& object : present) ids.push_back(object.id);
    NamesOfMap names = namesOfMap(QuadReader(environment->read()), ids);
    names.activities = activities;
    return names;
  }
  std::string history() const { return historyOf(environment->read()); }

  std::shared_ptr<Environment> environment = Environment::temporary();
  std::vector<ObjectMembers> present;
  std::set<std::string> activities;

 private:
  inline static int runs_ = 0;
};

/// The first map is the one that is copied.
inline LivingMap merged(const std::vector<const LivingMap*>& maps, const std::vector<ObjectMembers>& after,
                        const std::string& time) {
  LivingMap merged(*maps.front());
  std::vector<NamesOfMap> names;
  std::vector<QuadReader> quads;
  std::map<ContentHash, ObjectMembers> before;
  for (const LivingMap* map : maps) {
    names.push_back(map->names());
    quads.emplace_back(map->environment->read());
    for (const ObjectMembers& object : map->present) before.emplace(object.id, object);
    merged.activities.insert(map->activities.begin(), map->activities.end());
  }
  std::vector<const QuadReader*> readers;
  for (const QuadReader& reader : quads) readers.push_back(&reader);
  std::vector<ObjectMembers> all;
  for (const auto& [id, object] : before) all.push_back(object);
  WriteTransaction transaction = merged.environment->write();
  copyHistories(names, readers, 0, transaction);
  writeThingsOfMerge(transaction, time, all, after, namesIn(names));
  transaction.commit();
  merged.present = after;
  return merged;
}

/// Each object has one name, each name one object or one end, and what has ended is replaced once and in no circle.
inline void expectSoundNames(const LivingMap& map) {
  const QuadReader quads(map.environment->read());
  const ThingLookup lookup(quads);
  std::set<std::string> held;
  for (const ObjectMembers& object : map.present) {
    ASSERT_EQ(lookup.thingsOf(object.id).size(), 1U);
    EXPECT_TRUE(held.insert(lookup.thingsOf(object.id).front().iri).second) << "two objects, one name";
  }
  for (const auto& [thing, since] : timesOfThings(quads)) {
    EXPECT_EQ(lookup.endsOf(thing).size(), held.contains(thing) ? 0U : 1U) << thing;
    ASSERT_LE(lookup.replacementsOf(thing).size(), held.contains(thing) ? 0U : 1U) << thing;
    std::set<std::string> seen;
    for (std::string next = thing; seen.insert(next).second;) {
      const std::vector<Term> heirs = lookup.replacementsOf(next);
      if (heirs.empty()) break;
      next = heirs.front().text;
      EXPECT_FALSE(seen.contains(next)) << thing << " is replaced in a circle";
    }
  }
}

inline std::string timeOf(int second) {
  return "2026-01-01T0" + std::to_string(second) + ".000000Z";
}

}  // namespace cluxel::mapping
