// SPDX-License-Identifier: Apache-2.0
// Quads are copied by their terms: term ids differ between stores.
#include "mapping/build/operator_statements.hpp"

#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

std::uint64_t copyOperatorStatements(const rdf::QuadReader& from, rdf::WriteTransaction& into) {
  const auto graph = from.idOf(Term::iri(rdf::vocabulary::kGraphOperator));
  if (!graph) return 0;
  rdf::QuadWriter writer(into);
  rdf::QuadPattern pattern;
  pattern.g = *graph;
  rdf::QuadCursor cursor = from.scan(pattern);
  std::uint64_t count = 0;
  for (rdf::QuadIds quad; cursor.next(quad); ++count)
    writer.add(Quad{from.termOf(quad.s), from.termOf(quad.p), from.termOf(quad.o),
                    Term::iri(rdf::vocabulary::kGraphOperator)});
  writer.flush();
  return count;
}

void clearOperatorStatements(rdf::WriteTransaction& transaction) {
  rdf::QuadWriter writer(transaction);
  writer.clearGraph(writer.intern(Term::iri(rdf::vocabulary::kGraphOperator)));
  writer.flush();
}

}  // namespace cluxel::mapping
