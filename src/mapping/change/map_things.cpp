// SPDX-License-Identifier: Apache-2.0
// `object prov:specializationOf thing` for every object that there was; a thing has at most one present object.
#include "mapping/change/map_things.hpp"

#include <algorithm>
#include <functional>
#include <set>

#include "mapping/change/object_successors.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::kGraphHistory;

/// Objects before and after a change, matched by successorsOf().
struct Heirs {
  std::vector<std::vector<std::size_t>> before_of;     ///< by object after: those whose name it may inherit
  std::vector<std::vector<std::size_t>> ancestors_of;  ///< by object after: all that went on in it
  std::vector<std::optional<std::size_t>> heir_of;     ///< by object before: the one that may inherit its name
};

/// The objects that have the same name before and after, each with its number before. Objects of one map have no common
/// members, so that such an object has no other predecessor; one that is named by its class always continues.
/// Objects of several maps may share members: then the list is empty.
std::map<ContentHash, std::size_t> sameObjects(const std::vector<ObjectMembers>& before,
                                               const std::vector<ObjectMembers>& after, ObjectsOf objects_of) {
  std::map<ContentHash, std::size_t> number_before, same;
  if (objects_of == ObjectsOf::SeveralMaps) return same;
  for (std::size_t b = 0; b < before.size(); ++b)
    if (!before[b].seeds.empty()) number_before.emplace(before[b].id, b);
  for (const ObjectMembers& object : after)
    if (const auto found = number_before.find(object.id); found != number_before.end()) same.insert(*found);
  return same;
}

Heirs heirsOf(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after, ObjectsOf objects_of) {
  Heirs heirs{std::vector<std::vector<std::size_t>>(after.size()), std::vector<std::vector<std::size_t>>(after.size()),
              std::vector<std::optional<std::size_t>>(before.size())};
  std::vector<std::vector<std::size_t>> by_place_of(after.size());
  const auto same = sameObjects(before, after, objects_of);
  ObjectList others_before, others_after;
  std::vector<std::size_t> number_before, number_after;
  for (std::size_t a = 0; a < after.size(); ++a)
    if (const auto found = same.find(after[a].id); found != same.end())
      heirs.before_of[a] = heirs.ancestors_of[a] = {found->second}, heirs.heir_of[found->second] = a;
    else
      others_after.push_back(&after[a]), number_after.push_back(a);
  for (std::size_t b = 0; b < before.size(); ++b)
    if (!same.contains(before[b].id)) others_before.push_back(&before[b]), number_before.push_back(b);
  const auto successors = successorsOf(others_before, objects_of, others_after);
  for (std::size_t i = 0; i < successors.size(); ++i) {
    const std::size_t b = number_before[i];
    std::optional<std::size_t>& heir = heirs.heir_of[b];
    std::size_t most = 0;
    bool is_by_place = false;
    for (const auto& [other, count, by_place] : successors[i]) {
      const std::size_t a = number_after[other];
      heirs.ancestors_of[a].push_back(b);
      if (heir && (count < most || (count == most && after[*heir].id < after[a].id))) continue;
      heir = a, most = count, is_by_place = by_place;
    }
    if (heir) (is_by_place ? by_place_of[*heir] : heirs.before_of[*heir]).push_back(b);
  }
  // A name that seeds hand on is surer than one that places do.
  for (std::size_t a = 0; a < after.size(); ++a)
    if (heirs.before_of[a].empty()) heirs.before_of[a] = std::move(by_place_of[a]);
  return heirs;
}

class Naming {
 public:
  Naming(rdf::WriteTransaction& transaction, std::string time, const IsInBoth& is_in_both)
      : reader_(static_cast<const rdf::ReadTransaction&>(transaction)),
        stored_(reader_),
        writer_(transaction),
        time_(std::move(time)),
        is_in_both_(is_in_both) {}

  void run(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after, ObjectsOf objects_of) {
    const Heirs heirs = heirsOf(before, after, objects_of);
    std::vector<std::optional<Thing>> names(after.size());
    const std::vector<char> is_back = areBack(before, after);
    const auto inherit = [&](std::size_t a) { names[a] = held(inherited(before, heirs.before_of[a])); };
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] == 0) inherit(a);
    // Of several that had the same name, the one to which it would come anyway is first.
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] != 0 && hadName(after[a].id, inherited(before, heirs.before_of[a]))) inherit(a);
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] != 0 && !names[a]) names[a] = returned(after[a].id);
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] != 0 && !names[a]) inherit(a);
    for (std::size_t a = 0; a < after.size(); ++a) {
      if (names[a]) continue;
      names[a] = named(after[a].id);
      for (const std::size_t b : heirs.ancestors_of[a]) derive(names[a]->iri, nameOf(before[b].id).iri);
    }
    for (std::size_t a = 0; a < after.size(); ++a) link(after[a].id, *names[a]);
    for (std::size_t b = 0; b < before.size(); ++b) {
      std::vector<Thing> things = thingsOf(before[b].id);  // two where several maps named the object
      if (things.empty()) things = {nameOf(before[b].id)};
      for (const Thing& thing : things)
        if (!isHeld(thing.iri)) end(thing, heirs.heir_of[b] ? names[*heirs.heir_of[b]] : std::nullopt);
    }
    writer_.flush();
  }

 private:
  void add(const std::string& subject, const std::string& property, const Term& object) {
    writer_.add(Quad{Term::iri(subject), Term::iri(property), object, Term::iri(kGraphHistory)});
  }
  void remove(const std::string& subject, const std::string& property, const Term& object) {
    writer_.remove(rdf::QuadIds{writer_.intern(Term::iri(subject)), writer_.intern(Term::iri(property)),
                                writer_.intern(object), writer_.intern(Term::iri(kGraphHistory))});
  }
  Term timeTerm() const { return Term::literal(time_, rdf::vocabulary::xsd("dateTime")); }
  void derive(const std::string& thing, const std::string& from) {
    if (thing != from) add(thing, provenance("wasDerivedFrom"), Term::iri(from));
  }

  /// Which objects come back: they have a thing from earlier, and were not there before this change.
  std::vector<char> areBack(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after) {
    std::set<ContentHash> there;
    for (const ObjectMembers& object : before) there.insert(object.id);
    std::vector<char> are_back;
    for (const ObjectMembers& object : after)
      are_back.push_back(!there.contains(object.id) && !thingsOf(object.id).empty() ? 1 : 0);
    return are_back;
  }

  /// The oldest of the names that meet in an object and that no other has. The others end.
  std::optional<Thing> inherited(const std::vector<ObjectMembers>& before, const std::vector<std::size_t>& from) {
    std::optional<Thing> oldest;
    for (const std::size_t b : from)
      if (const Thing claim = nameOf(before[b].id); !held_.contains(claim.iri) && (!oldest || claim < *oldest))
        oldest = claim;
    return oldest;
  }

  bool hadName(const ContentHash& object, const std::optional<Thing>& name) {
    const std::vector<Thing>& things = thingsOf(object);
    return name &&
           std::any_of(things.begin(), things.end(), [&](const Thing& thing) { return thing.iri == name->iri; });
  }

  std::optional<Thing> returned(const ContentHash& object) {
    for (const Thing& thing : thingsOf(object))
      if (!isHeld(thing.iri)) return held(thing);
    return std::nullopt;
  }

  /// The thing goes on: it has not ended.
  std::optional<Thing> held(std::optional<Thing> thing) {
    if (!thing || !held_.insert(thing->iri).second) return thing;
    for (const Term& time : stored_.endsOf(thing->iri)) remove(thing->iri, provenance("invalidatedAtTime"), time);
    for (const Term& other : stored_.replacementsOf(thing->iri)) remove(thing->iri, isReplacedBy(), other);
    return thing;
  }

  const std::vector<Thing>& thingsOf(const ContentHash& object) {
    const auto [entry, is_new] = things_.try_emplace(object);
    if (is_new) entry->second = stored_.thingsOf(object);
    return entry->second;
  }
  Thing nameOf(const ContentHash& object) {
    thingsOf(object);
    return thingOf(things_, object);
  }

  /// Whether a thing has an object after the change.
  bool isHeld(const std::string& thing) {
    if (held_.contains(thing)) return true;
    if (!is_in_both_) return false;
    const std::vector<ContentHash> objects = stored_.objectsOf(thing);
    return std::any_of(objects.begin(), objects.end(),
                       [&](const ContentHash& object) { return is_in_both_(object) && nameOf(object).iri == thing; });
  }

  Thing named(const ContentHash& object) {
    std::string iri = rdf::iriOfThing(object);
    for (std::uint32_t n = 1; stored_.since(iri) || isHeld(iri); ++n)
      iri = rdf::iriOfThing(ContentHasher().add(object).add(n).finish());
    held_.insert(iri);
    add(iri, provenance("generatedAtTime"), timeTerm());
    return {iri, time_};
  }

  void link(const ContentHash& object, const Thing& thing) {
    const std::string iri = rdf::iriOfObject(object);
    bool is_linked = false;
    for (const Thing& other : thingsOf(object)) {
      is_linked = is_linked || other.iri == thing.iri;
      if (other.iri == thing.iri) continue;
      remove(iri, provenance("specializationOf"), Term::iri(other.iri));
      if (!isHeld(other.iri)) end(other, thing);
    }
    if (!is_linked) add(iri, provenance("specializationOf"), Term::iri(thing.iri));
  }

  /// `heir`: the thing whose object continues that of the one that ends. A thing that ended earlier keeps that time.
  void end(const Thing& thing, const std::optional<Thing>& heir) {
    if (!ended_.insert(thing.iri).second) return;
    if (stored_.endsOf(thing.iri).empty()) add(thing.iri, provenance("invalidatedAtTime"), timeTerm());
    if (!heir) return;
    derive(heir->iri, thing.iri);
    add(thing.iri, isReplacedBy(), Term::iri(heir->iri));
  }

  rdf::QuadReader reader_;  ///< sees the state before, since the writer flushes at the end
  ThingLookup stored_;
  rdf::QuadWriter writer_;
  std::string time_;
  const IsInBoth& is_in_both_;
  Things things_;               ///< of the objects that were looked up
  std::set<std::string> held_;  ///< things that an object of the change has after it
  std::set<std::string> ended_;
};

}  // namespace

void writeThings(rdf::WriteTransaction& transaction, const std::string& time, const std::vector<ObjectMembers>& before,
                 const std::vector<ObjectMembers>& after, ObjectsOf objects_of, const IsInBoth& is_in_both) {
  Naming(transaction, time, is_in_both).run(before, after, objects_of);
}

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

Lineage::Lineage(const rdf::QuadReader& quads, const std::vector<ContentHash>& present)
    : things_(storedThings(quads)), times_(timesOfThings(quads)) {
  for (const ContentHash& object : present) object_of_[thingOf(things_, object).iri] = object;
  forEachHistoryLink(quads, "wasDerivedFrom", [&](const Term& thing, const Term& from) {
    if (hashIn(thing.text, "thing")) later_.emplace(from.text, thing.text);
  });
  forEachHistoryLink(quads, isReplacedBy(),
                     [&](const Term& thing, const Term& heir) { replaced_by_.emplace(thing.text, heir.text); });
}

Lineage::Meaning Lineage::meaningOf(const std::string& name) const {
  const auto localOf = [](const std::string& iri) { return iri.substr(iri.rfind('/') + 1); };
  Meaning meaning;
  const auto addThing = [&](const std::string& iri) {
    meaning.things.insert(iri);
    meaning.text = "thing/" + localOf(iri);
  };
  const auto addObject = [&](const ContentHash& object, const std::vector<Thing>& of_object) {
    meaning.things.insert(of_object.front().iri);
    if (meaning.text.empty()) meaning.text = "former object/" + object.hex();
  };
  if (const auto object = hashIn(name, "object")) {
    if (const auto known = things_.find(*object); known != things_.end()) addObject(*object, known->second);
    return meaning;
  }
  if (hashIn(name, "thing")) {
    if (times_.contains(name)) addThing(name);
    return meaning;
  }
  const auto fits = [&](const std::string& kind, const std::string& hex) {
    const std::string path = kind + "/" + hex;
    return path.starts_with(name) || hex.starts_with(name) || name.ends_with("/map/" + path);
  };
  for (const auto& [iri, time] : times_)
    if (fits("thing", localOf(iri))) addThing(iri);
  for (const auto& [object, of_object] : things_)
    if (fits("object", object.hex())) addObject(object, of_object);
  return meaning;
}

std::optional<FormerName> Lineage::find(const std::string& name) const {
  const Meaning meaning = meaningOf(name);
  std::set<ContentHash> found;
  std::set<std::string> seen = meaning.things;
  for (std::vector<std::string> open(seen.begin(), seen.end()); !open.empty();) {
    const std::string thing = open.back();
    open.pop_back();
    if (const auto object = object_of_.find(thing); object != object_of_.end()) {
      found.insert(object->second);
      continue;  // the object kept its name; other successors do not matter
    }
    const auto& later = replaced_by_.contains(thing) ? replaced_by_ : later_;
    const auto [begin, end] = later.equal_range(thing);
    for (auto next = begin; next != end; ++next)
      if (seen.insert(next->second).second) open.push_back(next->second);
  }
  if (found.size() != 1) return std::nullopt;
  return FormerName{*found.begin(), meaning.text};
}

}  // namespace cluxel::mapping
