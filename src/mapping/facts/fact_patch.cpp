// SPDX-License-Identifier: Apache-2.0
// The difference of two sorted lists.
#include "mapping/facts/fact_patch.hpp"

#include <algorithm>

namespace cluxel::mapping {

void FactPatch::replace(std::optional<rdf::TermId> subject, std::optional<rdf::TermId> property,
                        std::optional<rdf::TermId> object) {
  rdf::QuadCursor cursor = stored_.scan({.s = subject, .p = property, .o = object, .g = graph_});
  for (rdf::QuadIds quad; cursor.next(quad);) old_.insert(quad);
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
    if (quad.p != kept_property) old_.insert(quad);
}

void FactPatch::write(std::vector<rdf::QuadIds> fresh, rdf::QuadWriter& writer) const {
  std::sort(fresh.begin(), fresh.end());
  fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
  for (const rdf::QuadIds& quad : old_)
    if (!std::binary_search(fresh.begin(), fresh.end(), quad)) writer.remove(quad);
  for (const rdf::QuadIds& quad : fresh)
    if (!old_.contains(quad)) writer.add(quad);
}

}  // namespace cluxel::mapping
