// SPDX-License-Identifier: Apache-2.0
// Scans of the properties that link things, objects and times.
#include "mapping/thing_history.hpp"

#include <algorithm>

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::kGraphHistory;

std::optional<rdf::TermId> provenanceTerm(const rdf::QuadReader& quads, std::string_view name) {
  return quads.idOf(Term::iri(name.find(':') == std::string_view::npos ? provenance(name) : std::string(name)));
}

}  // namespace

std::string provenance(std::string_view local) {
  return std::string(rdf::vocabulary::kProv).append(local);
}

std::string isReplacedBy() {
  return std::string(rdf::vocabulary::kDcTerms) + "isReplacedBy";
}

std::optional<ContentHash> hashIn(const std::string& iri, std::string_view kind) {
  const std::string start = rdf::mapIri(kind, "");
  if (!iri.starts_with(start) || iri.size() != start.size() + 32) return std::nullopt;
  try {
    return ContentHash::fromHex(std::string_view(iri).substr(start.size()));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

std::vector<Quad> quadsAbout(const rdf::QuadReader& quads, const std::string& subject, std::string_view graph) {
  const auto s = quads.idOf(Term::iri(subject)), g = quads.idOf(Term::iri(graph));
  std::vector<Quad> about;
  if (!s || !g) return about;
  rdf::QuadCursor cursor = quads.scan({.s = *s, .p = {}, .o = {}, .g = *g});
  for (rdf::QuadIds quad; cursor.next(quad);)
    about.push_back({quads.termOf(quad.s), quads.termOf(quad.p), quads.termOf(quad.o), quads.termOf(quad.g)});
  return about;
}

void forEachHistoryLink(const rdf::QuadReader& quads, std::string_view property,
                        const std::function<void(const Term& subject, const Term& object)>& visit) {
  const auto graph = quads.idOf(Term::iri(kGraphHistory)), predicate = provenanceTerm(quads, property);
  if (!graph || !predicate) return;
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = *predicate, .o = {}, .g = *graph});
  for (rdf::QuadIds quad; cursor.next(quad);) visit(quads.termOf(quad.s), quads.termOf(quad.o));
}

std::map<std::string, std::string> timesOfThings(const rdf::QuadReader& quads) {
  std::map<std::string, std::string> times;
  forEachHistoryLink(quads, "generatedAtTime", [&](const Term& subject, const Term& time) {
    if (!hashIn(subject.text, "thing")) return;
    const auto [entry, is_new] = times.emplace(subject.text, time.text);
    if (!is_new) entry->second = std::min(entry->second, time.text);
  });
  return times;
}

Things storedThings(const rdf::QuadReader& quads) {
  const std::map<std::string, std::string> times = timesOfThings(quads);
  Things things;
  forEachHistoryLink(quads, "specializationOf", [&](const Term& subject, const Term& object) {
    const auto id = hashIn(subject.text, "object");
    if (!id || !hashIn(object.text, "thing")) return;
    const auto time = times.find(object.text);
    things[*id].push_back({object.text, time == times.end() ? "" : time->second});
  });
  for (auto& [id, of_object] : things) std::sort(of_object.begin(), of_object.end());
  return things;
}

Thing thingOf(const Things& things, const ContentHash& object) {
  const auto known = things.find(object);
  return known == things.end() ? Thing{rdf::iriOfThing(object), ""} : known->second.front();
}

ThingLookup::ThingLookup(const rdf::QuadReader& quads)
    : quads_(quads),
      graph_(quads.idOf(Term::iri(kGraphHistory))),
      of_(provenanceTerm(quads, "specializationOf")),
      begin_(provenanceTerm(quads, "generatedAtTime")),
      end_(provenanceTerm(quads, "invalidatedAtTime")),
      replaced_(provenanceTerm(quads, isReplacedBy())) {}

std::vector<Thing> ThingLookup::thingsOf(const ContentHash& object) const {
  std::vector<Thing> things;
  for (const Term& thing : valuesOf(rdf::iriOfObject(object), of_))
    if (hashIn(thing.text, "thing")) things.push_back({thing.text, since(thing.text).value_or("")});
  std::sort(things.begin(), things.end());
  return things;
}

std::optional<std::string> ThingLookup::since(const std::string& thing) const {
  std::optional<std::string> first;
  for (const Term& time : valuesOf(thing, begin_)) first = first ? std::min(*first, time.text) : time.text;
  return first;
}

std::vector<Term> ThingLookup::endsOf(const std::string& thing) const {
  return valuesOf(thing, end_);
}

std::vector<Term> ThingLookup::replacementsOf(const std::string& thing) const {
  return valuesOf(thing, replaced_);
}

std::vector<ContentHash> ThingLookup::objectsOf(const std::string& thing) const {
  std::vector<ContentHash> objects;
  const auto object = quads_.idOf(Term::iri(thing));
  if (!graph_ || !of_ || !object) return objects;
  rdf::QuadCursor cursor = quads_.scan({.s = {}, .p = *of_, .o = *object, .g = *graph_});
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (const auto id = hashIn(quads_.termOf(quad.s).text, "object")) objects.push_back(*id);
  return objects;
}

std::vector<Term> ThingLookup::valuesOf(const std::string& subject, std::optional<rdf::TermId> property) const {
  std::vector<Term> values;
  const auto term = quads_.idOf(Term::iri(subject));
  if (!graph_ || !property || !term) return values;
  rdf::QuadCursor cursor = quads_.scan({.s = *term, .p = *property, .o = {}, .g = *graph_});
  for (rdf::QuadIds quad; cursor.next(quad);) values.push_back(quads_.termOf(quad.o));
  return values;
}

}  // namespace cluxel::mapping
