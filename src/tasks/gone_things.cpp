// SPDX-License-Identifier: Apache-2.0
// The map states it as a fact of the object.
#include "tasks/gone_things.hpp"

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

namespace {

/// Finds the names of the property and of the graph once for many objects.
class ObservedTimes {
 public:
  explicit ObservedTimes(const rdf::QuadReader& quads)
      : quads_(quads),
        property_(quads.idOf(Term::iri(rdf::vocabulary::clx("seenThrough")))),
        graph_(quads.idOf(Term::iri(std::string(rdf::vocabulary::kGraphObserved)))) {}

  std::optional<rdf::TermId> of(const std::string& object_iri) const {
    if (!property_ || !graph_) return std::nullopt;
    const auto object = quads_.idOf(Term::iri(object_iri));
    rdf::QuadIds quad;
    if (!object || !quads_.scan({.s = object, .p = property_, .o = {}, .g = graph_}).next(quad)) return std::nullopt;
    return quad.o;
  }

 private:
  const rdf::QuadReader& quads_;
  std::optional<rdf::TermId> property_, graph_;
};

}  // namespace

std::optional<std::string> seenThrough(const rdf::QuadReader& quads, const std::string& object_iri) {
  const auto time = ObservedTimes(quads).of(object_iri);
  if (!time) return std::nullopt;
  return quads.termOf(*time).text;
}

std::vector<bool> goneAmong(const mapping::MapReader& map) {
  const ObservedTimes times(map.quads());
  std::vector<bool> is_gone;
  is_gone.reserve(map.objectIds().size());
  for (const ContentHash& object : map.objectIds()) is_gone.push_back(times.of(rdf::iriOfObject(object)).has_value());
  return is_gone;
}

}  // namespace cluxel::tasks
