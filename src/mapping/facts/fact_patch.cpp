// SPDX-License-Identifier: Apache-2.0
// The difference of two sorted lists.
#include "mapping/facts/fact_patch.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

std::vector<rdf::TermId> subjectsOfObject(const rdf::QuadReader& stored, rdf::TermId graph, rdf::TermId object) {
  std::vector<rdf::TermId> subjects{object};
  const std::string geo(rdf::vocabulary::kGeo), sosa(rdf::vocabulary::kSosa);
  const auto idOf = [&](const std::string& iri) { return stored.idOf(Term::iri(iri)); };
  rdf::QuadIds quad;
  // A property that is not known has no facts.
  for (const std::string& iri : {rdf::vocabulary::clx("hasPart"), geo + "hasCentroid", geo + "hasBoundingBox"})
    if (const auto property = idOf(iri)) {
      rdf::QuadCursor cursor = stored.scan({.s = object, .p = property, .o = {}, .g = graph});
      while (cursor.next(quad)) subjects.push_back(quad.o);
    }
  if (const auto property = idOf(sosa + "hasFeatureOfInterest")) {
    rdf::QuadCursor cursor = stored.scan({.s = {}, .p = property, .o = object, .g = graph});
    while (cursor.next(quad)) subjects.push_back(quad.s);
  }
  return subjects;
}

void FactPatch::replace(std::optional<rdf::TermId> subject, std::optional<rdf::TermId> property,
                        std::optional<rdf::TermId> object) {
  rdf::QuadCursor cursor = stored_.scan({.s = subject, .p = property, .o = object, .g = graph_});
  for (rdf::QuadIds quad; cursor.next(quad);) old_.push_back(quad);
}

std::vector<rdf::TermId> FactPatch::objectsOf(rdf::TermId subject, rdf::TermId property) const {
  std::vector<rdf::TermId> objects;
  rdf::QuadCursor cursor = stored_.scan({.s = subject, .p = property, .o = {}, .g = graph_});
  for (rdf::QuadIds quad; cursor.next(quad);) objects.push_back(quad.o);
  return objects;
}

std::vector<rdf::TermId> FactPatch::subjectsOf(rdf::TermId property, rdf::TermId object) const {
  std::vector<rdf::TermId> subjects;
  rdf::QuadCursor cursor = stored_.scan({.s = {}, .p = property, .o = object, .g = graph_});
  for (rdf::QuadIds quad; cursor.next(quad);) subjects.push_back(quad.s);
  return subjects;
}

void FactPatch::replaceBut(rdf::TermId subject, rdf::TermId kept_property) {
  rdf::QuadCursor cursor = stored_.scan({.s = subject, .p = {}, .o = {}, .g = graph_});
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (quad.p != kept_property) old_.push_back(quad);
}

void FactPatch::write(std::vector<rdf::QuadIds> fresh, rdf::QuadWriter& writer) {
  for (std::vector<rdf::QuadIds>* quads : {&fresh, &old_}) {
    std::sort(quads->begin(), quads->end());
    quads->erase(std::unique(quads->begin(), quads->end()), quads->end());
  }
  rdf::QuadDifference difference;
  std::set_difference(fresh.begin(), fresh.end(), old_.begin(), old_.end(), std::back_inserter(difference.added));
  std::set_difference(old_.begin(), old_.end(), fresh.begin(), fresh.end(), std::back_inserter(difference.removed));
  writer.change(difference);
}

}  // namespace cluxel::mapping
