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

/// An object before that goes on in one after.
struct Predecessor {
  std::size_t number = 0;  ///< before
  std::size_t shared = 0;  ///< members
};

/// Objects before and after a change, matched by successorsOf().
struct Heirs {
  std::vector<std::vector<Predecessor>> before_of;     ///< by object after: those whose name it may inherit
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
  Heirs heirs{std::vector<std::vector<Predecessor>>(after.size()), std::vector<std::vector<std::size_t>>(after.size()),
              std::vector<std::optional<std::size_t>>(before.size())};
  std::vector<std::vector<Predecessor>> by_place_of(after.size());
  const auto same = sameObjects(before, after, objects_of);
  ObjectList others_before, others_after;
  std::vector<std::size_t> number_before, number_after;
  for (std::size_t a = 0; a < after.size(); ++a)
    if (const auto found = same.find(after[a].id); found != same.end())
      heirs.before_of[a] = {{found->second}}, heirs.ancestors_of[a] = {found->second}, heirs.heir_of[found->second] = a;
    else
      others_after.push_back(&after[a]), number_after.push_back(a);
  for (std::size_t b = 0; b < before.size(); ++b)
    if (!same.contains(before[b].id)) others_before.push_back(&before[b]), number_before.push_back(b);
  const auto successors = successorsOf(others_before, objects_of, others_after);
  for (std::size_t i = 0; i < successors.size(); ++i) {
    const std::size_t b = number_before[i];
    std::optional<std::size_t>& heir = heirs.heir_of[b];
    const SharedMembers* most = nullptr;
    for (const SharedMembers& successor : successors[i]) {
      const std::size_t a = number_after[successor.other];
      heirs.ancestors_of[a].push_back(b);
      if (heir && after[*heir].id == before[b].id) continue;  // it is the same
      const bool is_same = after[a].id == before[b].id;
      if (most != nullptr && !is_same &&
          (successor.count < most->count || (successor.count == most->count && after[*heir].id < after[a].id)))
        continue;
      heir = a, most = &successor;
    }
    if (!heir) continue;
    const bool is_sure = !most->is_by_place || 2 * most->count > before[b].seeds.size();
    (is_sure ? heirs.before_of[*heir] : by_place_of[*heir]).push_back({b, most->count});
  }
  // A name that seeds hand on, or most members by their places, is surer than one that some places do.
  for (std::size_t a = 0; a < after.size(); ++a)
    if (heirs.before_of[a].empty()) heirs.before_of[a] = std::move(by_place_of[a]);
  return heirs;
}

class Naming {
 public:
  /// `names`: of a merge, those that objects have in the maps.
  Naming(rdf::WriteTransaction& transaction, std::string time, IsInBoth is_in_both, const NamesInMaps* names = nullptr)
      : reader_(static_cast<const rdf::ReadTransaction&>(transaction)),
        stored_(reader_),
        writer_(transaction),
        time_(std::move(time)),
        is_in_both_(std::move(is_in_both)) {
    if (names == nullptr) return;
    in_maps_.emplace();
    for (const auto& [object, things] : names->of_object)
      for (const std::string& thing : things) (*in_maps_)[object].push_back({thing, stored_.since(thing).value_or("")});
    for (auto& [object, things] : *in_maps_) std::sort(things.begin(), things.end());
    for (const std::string& thing : names->outdated) {
      if (!stored_.replacementsOf(thing).empty())
        replaced_since_.insert(thing);
      else if (!stored_.endsOf(thing).empty())
        ended_since_.insert(thing);
    }
    replaced_ = replaced_since_;
  }

  void run(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after, ObjectsOf objects_of) {
    const Heirs heirs = heirsOf(before, after, objects_of);
    std::vector<std::optional<Thing>> names(after.size());
    if (in_maps_) names = keptNames(after, *in_maps_);
    for (const std::optional<Thing>& name : names) held(name);
    for (const ObjectMembers& object : before)
      for (const Thing& thing : namesOf(object.id)) had_object_.insert(thing.iri);
    const std::vector<char> is_back = areBack(before, after);
    const auto inherit = [&](std::size_t a) { names[a] = held(inherited(before, heirs.before_of[a])); };
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] == 0 && !names[a]) inherit(a);
    // Of several that had the same name, the one to which it would come anyway is first.
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] != 0 && !names[a] && hadName(after[a].id, inherited(before, heirs.before_of[a]))) inherit(a);
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] != 0 && !names[a]) names[a] = returned(after[a].id);
    for (std::size_t a = 0; a < after.size(); ++a)
      if (is_back[a] != 0 && !names[a]) inherit(a);
    for (std::size_t a = 0; a < after.size(); ++a) {
      if (names[a]) continue;
      names[a] = named(after[a].id);
      for (const std::size_t b : heirs.ancestors_of[a])
        for (const Thing& thing : namesOf(before[b].id)) derive(names[a]->iri, thing.iri);
    }
    for (std::size_t a = 0; a < after.size(); ++a) link(after[a].id, *names[a]);
    for (std::size_t b = 0; b < before.size(); ++b)
      for (const Thing& thing : namesOf(before[b].id)) {
        if (isHeld(thing.iri)) continue;
        const std::optional<std::size_t> heir = heirs.heir_of[b];
        const bool goes_on = heir && (!ended_since_.contains(thing.iri) || holdsMostOf(before[b], after[*heir]));
        end(thing, goes_on ? names[*heir] : std::nullopt);
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

  /// The oldest of the names that meet in an object and that no other has, of equally old ones that of which most goes
  /// on. The others end.
  std::optional<Thing> inherited(const std::vector<ObjectMembers>& before, const std::vector<Predecessor>& from) {
    std::optional<Thing> oldest;
    std::size_t most = 0;
    for (const auto& [b, shared] : from)
      for (const Thing& claim : namesOf(before[b].id)) {
        if (held_.contains(claim.iri)) continue;
        if (oldest && std::tie(oldest->since, shared, oldest->iri) <= std::tie(claim.since, most, claim.iri)) continue;
        oldest = claim, most = shared;
      }
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

  /// The names of an object before: its thing, or those that maps give it.
  std::vector<Thing> namesOf(const ContentHash& object) {
    if (!in_maps_) return {nameOf(object)};
    std::vector<Thing> names;
    if (const auto known = in_maps_->find(object); known != in_maps_->end()) names = known->second;
    std::erase_if(names, [&](const Thing& thing) { return replaced_since_.contains(thing.iri); });
    return names;
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
      if (!isHeld(other.iri) && !had_object_.contains(other.iri)) end(other, thing);
    }
    if (!is_linked) add(iri, provenance("specializationOf"), Term::iri(thing.iri));
  }

  /// `heir`: the thing whose object continues that of the one that ends. A thing that ended earlier keeps that time,
  /// and what has replaced it since. Of several objects with this name the first with an heir counts.
  void end(const Thing& thing, const std::optional<Thing>& heir) {
    if (stored_.endsOf(thing.iri).empty()) add(thing.iri, provenance("invalidatedAtTime"), timeTerm());
    if (!heir || !replaced_.insert(thing.iri).second) return;
    derive(heir->iri, thing.iri);
    const std::vector<Term> earlier = stored_.replacementsOf(thing.iri);
    if (!earlier.empty() && !had_object_.contains(thing.iri)) return;
    for (const Term& other : earlier) remove(thing.iri, isReplacedBy(), other);
    add(thing.iri, isReplacedBy(), Term::iri(heir->iri));
  }

  rdf::QuadReader reader_;  ///< sees the state before, since the writer flushes at the end
  ThingLookup stored_;
  rdf::QuadWriter writer_;
  std::string time_;
  IsInBoth is_in_both_;
  Things things_;                         ///< of the objects that were looked up
  std::optional<Things> in_maps_;         ///< of a merge
  std::set<std::string> replaced_since_;  ///< of a merge: those that what became of an older map has replaced
  std::set<std::string> ended_since_;     ///< of a merge: those that it has ended, and replaced by nothing
  std::set<std::string> had_object_;      ///< things of objects before
  std::set<std::string> held_;            ///< things that an object of the change has after it
  std::set<std::string> replaced_;        ///< things of which it is written what replaces them
};

}  // namespace

void writeThings(rdf::WriteTransaction& transaction, const std::string& time, const std::vector<ObjectMembers>& before,
                 const std::vector<ObjectMembers>& after, const IsInBoth& is_in_both) {
  Naming(transaction, time, is_in_both).run(before, after, ObjectsOf::OneMap);
}

void writeThingsOfMerge(rdf::WriteTransaction& transaction, const std::string& time,
                        const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after,
                        const NamesInMaps& names) {
  Naming(transaction, time, {}, &names).run(before, after, ObjectsOf::SeveralMaps);
  keepOneReplacementEach(transaction);
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
