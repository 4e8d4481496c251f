// SPDX-License-Identifier: Apache-2.0
// Quad by quad, by the terms' texts: two stores number terms differently.
#include "mapping/operator_statements.hpp"

#include "cluxel/knowledge/vocabulary.hpp"

namespace cluxel {

std::uint64_t copyOperatorStatements(const QuadReader& from, WriteTransaction& into) {
  const auto graph = from.idOf(Term::iri(vocabulary::kGraphOperator));
  if (!graph) return 0;
  QuadWriter writer(into);
  QuadPattern pattern;
  pattern.g = *graph;
  QuadCursor cursor = from.scan(pattern);
  std::uint64_t count = 0;
  for (QuadIds quad; cursor.next(quad); ++count)
    writer.add(
        Quad{from.termOf(quad.s), from.termOf(quad.p), from.termOf(quad.o), Term::iri(vocabulary::kGraphOperator)});
  writer.flush();
  return count;
}

void clearOperatorStatements(WriteTransaction& transaction) {
  QuadWriter writer(transaction);
  writer.clearGraph(writer.intern(Term::iri(vocabulary::kGraphOperator)));
  writer.flush();
}

}  // namespace cluxel
