// SPDX-License-Identifier: Apache-2.0
// The map states it as a fact of the object.
#include "tasks/gone_things.hpp"

#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

std::optional<std::string> seenThrough(const rdf::QuadReader& quads, const std::string& object_iri) {
  rdf::QuadPattern pattern;
  pattern.p = quads.idOf(Term::iri(rdf::vocabulary::clx("seenThrough")));
  if (!pattern.p) return std::nullopt;
  pattern.s = quads.idOf(Term::iri(object_iri));
  rdf::QuadIds quad;
  if (!pattern.s || !quads.scan(pattern).next(quad)) return std::nullopt;
  return quads.termOf(quad.o).text;
}

}  // namespace cluxel::tasks
