// SPDX-License-Identifier: Apache-2.0
// Follows a name through graph `history`, from thing to thing.
#include "mapping/things/ended_names.hpp"

#include <algorithm>
#include <set>

#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::kGraphHistory;

/// "object/HEX" of an IRI of the map.
std::string pathOf(const std::string& iri) {
  return iri.substr(rdf::vocabulary::kMap.size());
}

/// The IRIs of former objects and of things that a name may mean.
std::set<std::string> irisNamed(const rdf::QuadReader& quads, const std::string& name) {
  if (hashIn(name, "object") || hashIn(name, "thing")) return {name};
  std::set<std::string> iris;
  const auto add = [&](const Term& named) {
    if (!hashIn(named.text, "object") && !hashIn(named.text, "thing")) return;
    const std::string path = pathOf(named.text);
    if (path.starts_with(name) || path.substr(path.find('/') + 1).starts_with(name)) iris.insert(named.text);
  };
  forEachHistoryLink(quads, "specializationOf",
                     [&](const Term& object, const Term& thing) { add(object), add(thing); });
  return iris;
}

/// What a thing went on as: what replaced it, else what was derived from it.
std::vector<std::string> thingsAfter(const rdf::QuadReader& quads, const ThingLookup& lookup,
                                     const std::string& thing) {
  std::vector<std::string> successors;
  for (const Term& heir : lookup.replacementsOf(thing)) successors.push_back(heir.text);
  const auto object = quads.idOf(Term::iri(thing)), from = quads.idOf(Term::iri(provenance("wasDerivedFrom"))),
             graph = quads.idOf(Term::iri(kGraphHistory));
  if (!successors.empty() || !object || !from || !graph) return successors;
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = *from, .o = *object, .g = *graph});
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (const Term later = quads.termOf(quad.s); hashIn(later.text, "thing")) successors.push_back(later.text);
  return successors;
}

/// What a thing led to: things, with itself, and the present objects of the last ones.
struct Descent {
  std::set<std::string> things;
  std::set<ContentHash> present;
};

Descent descentOf(const rdf::QuadReader& quads, const IsPresent& is_present, const std::string& thing) {
  const ThingLookup lookup(quads);
  Descent descent{{thing}, {}};
  for (std::vector<std::string> open{thing}; !open.empty();) {
    const std::string next = open.back();
    open.pop_back();
    const std::vector<ContentHash> objects = lookup.objectsOf(next);
    const auto there = std::find_if(objects.begin(), objects.end(), is_present);
    if (there != objects.end())
      descent.present.insert(*there);  // other successors do not matter
    else
      for (const std::string& successor : thingsAfter(quads, lookup, next))
        if (descent.things.insert(successor).second) open.push_back(successor);
  }
  return descent;
}

std::string valueOf(const std::vector<Quad>& about, const std::string& property) {
  for (const Quad& quad : about)
    if (quad.predicate.text == property) return quad.object.text;
  return "";
}

/// The last change that ended an object of one of the things; when none did, the last end of a thing.
void tellEnd(const rdf::QuadReader& quads, const std::set<std::string>& things, EndedName& name) {
  const ThingLookup lookup(quads);
  std::string last_end;
  for (const std::string& thing : things) {
    for (const Term& time : lookup.endsOf(thing)) last_end = std::max(last_end, time.text);
    for (const ContentHash& object : lookup.objectsOf(thing))
      for (const Quad& quad : quadsAbout(quads, rdf::iriOfObject(object), kGraphHistory)) {
        if (quad.predicate.text != provenance("wasInvalidatedBy")) continue;
        const std::vector<Quad> activity = quadsAbout(quads, quad.object.text, kGraphHistory);
        const std::string time = valueOf(activity, provenance("endedAtTime"));
        if (time <= name.time) continue;
        name.time = time, name.operation = valueOf(activity, rdf::vocabulary::clx("operation"));
      }
  }
  if (name.time.empty()) name.time = last_end;
}

}  // namespace

std::optional<EndedName> endOf(const rdf::QuadReader& quads, const IsPresent& is_present, const std::string& name) {
  const ThingLookup lookup(quads);
  std::set<std::string> things;
  std::string meaning;
  for (const std::string& iri : irisNamed(quads, name)) {
    const auto object = hashIn(iri, "object");
    const std::vector<Thing> of_object = object ? lookup.thingsOf(*object) : std::vector<Thing>();
    if (object ? of_object.empty() : !lookup.since(iri)) continue;
    things.insert(object ? of_object.front().iri : iri);
    if (meaning.empty()) meaning = pathOf(iri);
  }
  if (things.size() != 1) return std::nullopt;
  const Descent descent = descentOf(quads, is_present, *things.begin());
  if (descent.present.size() == 1) return std::nullopt;
  EndedName ended{.meaning = meaning, .went_on = descent.things.size() > 1};
  ended.later.assign(descent.present.begin(), descent.present.end());
  tellEnd(quads, descent.things, ended);
  return ended;
}

std::string textOf(const EndedName& name) {
  constexpr std::size_t kListed = 4;
  const std::size_t count = name.later.size();
  if (count > 0) {
    std::string text = name.meaning + " went on as " + std::to_string(count) + " objects: ";
    for (std::size_t i = 0; i < std::min(kListed, count); ++i)
      text += (i > 0 ? ", object/" : "object/") + name.later[i].hex();
    return text + (count > kListed ? " and others" : "");
  }
  std::string text = name.meaning + (name.went_on ? " went on under another name, which ended" : " ended");
  if (!name.time.empty()) text += " at " + name.time;
  if (!name.operation.empty()) text += " by `" + name.operation + "`";
  return text + ", and nothing that there is continues it";
}

}  // namespace cluxel::mapping
