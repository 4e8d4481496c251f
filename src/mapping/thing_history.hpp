// SPDX-License-Identifier: Apache-2.0
// What graph `history` says about things and their objects: of single ones, or of all.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/content_hash.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

struct Thing {
  std::string iri;
  std::string since;  ///< xsd:dateTime of its first object; empty when nobody wrote it down
  bool operator<(const Thing& other) const { return std::tie(since, iri) < std::tie(other.since, other.iri); }
};
using Things = std::map<ContentHash, std::vector<Thing>>;

/// A property of PROV.
std::string provenance(std::string_view local);
/// dcterms:isReplacedBy: the thing whose object continues that of a thing that has ended.
std::string isReplacedBy();
/// The hash in the IRI of a resource of the map, when it is of this kind ("object", "thing").
std::optional<ContentHash> hashIn(const std::string& iri, std::string_view kind);
/// The quads of one subject in a graph.
std::vector<Quad> quadsAbout(const rdf::QuadReader& quads, const std::string& subject, std::string_view graph);
/// Visits the subjects and objects of a property in graph history: one of PROV by its local name, or an IRI.
void forEachHistoryLink(const rdf::QuadReader& quads, std::string_view property,
                        const std::function<void(const Term& subject, const Term& object)>& visit);

/// The things of objects, present and former ones; the first of several is the name. An object of an older map has
/// none: its thing is the one that its own hash names.
Things storedThings(const rdf::QuadReader& quads);
Thing thingOf(const Things& things, const ContentHash& object);
/// First times of all things that there ever were, by IRI.
std::map<std::string, std::string> timesOfThings(const rdf::QuadReader& quads);

/// The same for single objects and things. Cost: that of what is asked for.
class ThingLookup {
 public:
  explicit ThingLookup(const rdf::QuadReader& quads);

  /// The things of an object, the first of them its name.
  std::vector<Thing> thingsOf(const ContentHash& object) const;
  /// The first time of a thing; absent when there never was one of this name.
  std::optional<std::string> since(const std::string& thing) const;
  /// The recorded ends of a thing.
  std::vector<Term> endsOf(const std::string& thing) const;
  /// What has replaced a thing.
  std::vector<Term> replacementsOf(const std::string& thing) const;
  /// The objects of which this is or was a thing.
  std::vector<ContentHash> objectsOf(const std::string& thing) const;

 private:
  std::vector<Term> valuesOf(const std::string& subject, std::optional<rdf::TermId> property) const;

  const rdf::QuadReader& quads_;
  std::optional<rdf::TermId> graph_, of_, begin_, end_, replaced_;
};

}  // namespace cluxel::mapping
