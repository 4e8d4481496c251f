// SPDX-License-Identifier: Apache-2.0
// Names are given out one after the other; an object for which one name is left takes it at once.
#include "mapping/things/merged_things.hpp"

#include <algorithm>
#include <deque>

#include "mapping/facts/map_history.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::kGraphHistory;

class KeptNames {
 public:
  KeptNames(const std::vector<ObjectMembers>& objects, const std::map<ContentHash, std::vector<Thing>>& names)
      : objects_(objects), left_(objects.size()), kept_(objects.size()) {
    for (std::size_t i = 0; i < objects.size(); ++i)
      if (const auto known = names.find(objects[i].id); known != names.end()) {
        left_[i] = known->second.size();
        for (const Thing& name : known->second) objects_of_[name].push_back(i);
      }
    for (auto& [name, of_name] : objects_of_)
      std::sort(of_name.begin(), of_name.end(), [&](std::size_t a, std::size_t b) { return isFirst(a, b); });
  }

  std::vector<std::optional<Thing>> run() {
    // By name, and not by object: of the objects that have this name alone the first one keeps it.
    for (const auto& [name, of_name] : objects_of_)
      for (const std::size_t object : of_name)
        if (left_[object] == 1) waiting_.emplace_back(object, &name);
    giveToThoseThatWait();
    for (const auto& [name, of_name] : objects_of_) {
      const auto open = std::find_if(of_name.begin(), of_name.end(), [&](std::size_t i) { return !kept_[i]; });
      if (taken_.contains(name) || open == of_name.end()) continue;
      waiting_.emplace_back(*open, &name);
      giveToThoseThatWait();
    }
    return std::move(kept_);
  }

 private:
  bool isFirst(std::size_t a, std::size_t b) const {
    const std::size_t members_a = objects_[a].seeds.size(), members_b = objects_[b].seeds.size();
    return members_a != members_b ? members_a > members_b : objects_[a].id < objects_[b].id;
  }

  void giveToThoseThatWait() {
    for (; !waiting_.empty(); waiting_.pop_front()) {
      const auto [object, name] = waiting_.front();
      if (kept_[object] || !taken_.insert(*name).second) continue;
      kept_[object] = *name;
      for (const std::size_t other : objects_of_.at(*name))
        if (!kept_[other] && --left_[other] == 1)
          if (const Thing* last = nameLeftFor(other)) waiting_.emplace_back(other, last);
    }
  }

  const Thing* nameLeftFor(std::size_t object) {
    if (names_of_.empty()) {
      names_of_.resize(objects_.size());
      for (const auto& [name, of_name] : objects_of_)
        for (const std::size_t i : of_name) names_of_[i].push_back(&name);
    }
    for (const Thing* name : names_of_[object])
      if (!taken_.contains(*name)) return name;
    return nullptr;
  }

  const std::vector<ObjectMembers>& objects_;
  std::map<Thing, std::vector<std::size_t>> objects_of_;  ///< by name, from the oldest on
  std::vector<std::vector<const Thing*>> names_of_;       ///< by object
  std::vector<std::size_t> left_;                         ///< names that no other object has taken, by object
  std::vector<std::optional<Thing>> kept_;
  std::set<Thing> taken_;
  std::deque<std::pair<std::size_t, const Thing*>> waiting_;
};

/// From the things that have an object back to those that they replaced, step by step.
class Replacements {
 public:
  explicit Replacements(const rdf::QuadReader& quads) {
    std::set<std::string> ended;
    forEachHistoryLink(quads, "invalidatedAtTime", [&](const Term& thing, const Term&) { ended.insert(thing.text); });
    forEachHistoryLink(quads, isReplacedBy(), [&](const Term& thing, const Term& heir) {
      heirs_of_[thing.text].insert(heir.text);
      replaced_by_[heir.text].insert(thing.text);
    });
    for (const auto& [heir, things] : replaced_by_)
      if (!ended.contains(heir)) present_.insert(heir);
  }

  /// Those that do not stay: thing and heir.
  std::vector<std::pair<std::string, std::string>> superfluous() {
    reachFrom(present_);
    std::set<std::string> last;
    for (const auto& [heir, things] : replaced_by_)
      if (!heirs_of_.contains(heir)) last.insert(heir);
    reachFrom(last);
    for (const auto& [thing, heirs] : heirs_of_)
      if (!reached_.contains(thing)) reachFrom({thing});  // it is in a circle
    std::vector<std::pair<std::string, std::string>> others;
    for (const auto& [thing, heirs] : heirs_of_)
      for (const std::string& heir : heirs)
        if (const auto stays = heir_of_.find(thing); stays == heir_of_.end() || stays->second != heir)
          others.emplace_back(thing, heir);
    return others;
  }

 private:
  void reachFrom(std::set<std::string> level) {
    reached_.insert(level.begin(), level.end());
    while (!level.empty()) {
      std::set<std::string> next;
      for (const std::string& heir : level)
        if (const auto things = replaced_by_.find(heir); things != replaced_by_.end())
          for (const std::string& thing : things->second)
            if (reached_.insert(thing).second) heir_of_[thing] = heir, next.insert(thing);
      level = std::move(next);
    }
  }

  std::map<std::string, std::set<std::string>> heirs_of_, replaced_by_;
  std::map<std::string, std::string> heir_of_;  ///< the one that stays
  std::set<std::string> present_, reached_;
};

void copyHistory(const rdf::QuadReader& from, rdf::WriteTransaction& into) {
  const auto graph = from.idOf(Term::iri(kGraphHistory));
  if (!graph) return;
  const auto begins = from.idOf(Term::iri(provenance("generatedAtTime"))),
             ends = from.idOf(Term::iri(provenance("invalidatedAtTime")));
  const rdf::QuadReader there(static_cast<const rdf::ReadTransaction&>(into));
  const ThingLookup things(there);
  rdf::QuadWriter writer(into);
  rdf::QuadCursor cursor = from.scan({.s = {}, .p = {}, .o = {}, .g = *graph});
  for (rdf::QuadIds quad; cursor.next(quad);) {
    const Quad copied{from.termOf(quad.s), from.termOf(quad.p), from.termOf(quad.o), Term::iri(kGraphHistory)};
    if ((quad.p == begins || quad.p == ends) && hashIn(copied.subject.text, "thing")) {
      // Of both maps it begins and ends with the earlier one. What has an object in one of them does not end.
      std::optional<std::string> known = quad.p == begins ? things.since(copied.subject.text) : std::nullopt;
      if (quad.p == ends)
        for (const Term& time : things.endsOf(copied.subject.text)) known = time.text;
      if (known && *known <= copied.object.text) continue;
      if (known)
        writer.remove(rdf::QuadIds{writer.intern(copied.subject), writer.intern(copied.predicate),
                                   writer.intern(Term::literal(*known, rdf::vocabulary::xsd("dateTime"))),
                                   writer.intern(copied.graph)});
    }
    writer.add(copied);
  }
  writer.flush();
}

void clearHistory(rdf::WriteTransaction& transaction) {
  const rdf::QuadReader quads(static_cast<const rdf::ReadTransaction&>(transaction));
  const auto graph = quads.idOf(Term::iri(kGraphHistory));
  if (!graph) return;
  rdf::QuadWriter writer(transaction);
  writer.clearGraph(*graph);
  writer.flush();
}

}  // namespace

bool NamesOfMap::wentInto(const NamesOfMap& other) const {
  return !activities.empty() && activities.size() < other.activities.size() &&
         std::includes(other.activities.begin(), other.activities.end(), activities.begin(), activities.end());
}

NamesOfMap namesOfMap(const rdf::QuadReader& quads, const std::vector<ContentHash>& present) {
  NamesOfMap names;
  names.activities = activitiesIn(quads);
  const ThingLookup lookup(quads);
  for (const ContentHash& object : present) {
    const std::vector<Thing> things = lookup.thingsOf(object);
    const std::string thing = things.empty() ? rdf::iriOfThing(object) : things.front().iri;
    names.thing_of.emplace(object, thing);
    names.things.insert(thing);
  }
  return names;
}

NamesInMaps namesIn(const std::vector<NamesOfMap>& maps) {
  NamesInMaps names;
  std::set<std::string> newest;
  for (const NamesOfMap& map : maps) {
    std::vector<const NamesOfMap*> later;
    for (const NamesOfMap& other : maps)
      if (map.wentInto(other)) later.push_back(&other);
    (later.empty() ? newest : names.outdated).insert(map.things.begin(), map.things.end());
    for (const auto& entry : map.thing_of)
      if (std::none_of(later.begin(), later.end(), [&](const NamesOfMap* other) {
            return other->thing_of.contains(entry.first) || other->things.contains(entry.second);
          }))
        names.of_object[entry.first].insert(entry.second);
  }
  for (const std::string& thing : newest) names.outdated.erase(thing);
  return names;
}

std::vector<std::optional<Thing>> keptNames(const std::vector<ObjectMembers>& objects,
                                            const std::map<ContentHash, std::vector<Thing>>& names) {
  return KeptNames(objects, names).run();
}

void copyHistories(const std::vector<NamesOfMap>& names, const std::vector<const rdf::QuadReader*>& maps,
                   std::size_t base, rdf::WriteTransaction& into) {
  const auto isOutOfDate = [&](std::size_t map) {
    return std::any_of(names.begin(), names.end(), [&](const NamesOfMap& other) { return names[map].wentInto(other); });
  };
  if (isOutOfDate(base)) clearHistory(into);
  for (std::size_t map = 0; map < maps.size(); ++map)
    if (map != base && !isOutOfDate(map)) copyHistory(*maps[map], into);
}

void keepOneReplacementEach(rdf::WriteTransaction& transaction) {
  const rdf::QuadReader quads(static_cast<const rdf::ReadTransaction&>(transaction));
  rdf::QuadWriter writer(transaction);
  for (const auto& [thing, heir] : Replacements(quads).superfluous())
    writer.remove(rdf::QuadIds{writer.intern(Term::iri(thing)), writer.intern(Term::iri(isReplacedBy())),
                               writer.intern(Term::iri(heir)), writer.intern(Term::iri(kGraphHistory))});
  writer.flush();
}

}  // namespace cluxel::mapping
