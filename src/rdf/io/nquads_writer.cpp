// SPDX-License-Identifier: Apache-2.0
// Sorted canonical N-Quads.
#include <algorithm>
#include <vector>

#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

void writeSortedNQuads(const QuadReader& reader, const TextSink& out, const std::function<bool(const Quad&)>& keep) {
  std::vector<std::string> lines;
  QuadCursor cursor = reader.scan({}, QuadOrder::Spog);
  for (QuadIds ids; cursor.next(ids);) {
    const Quad quad{reader.termOf(ids.s), reader.termOf(ids.p), reader.termOf(ids.o), reader.termOf(ids.g)};
    if (!keep || keep(quad)) lines.push_back(toNQuads(quad));
  }
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  for (const std::string& line : lines) out(line);
}

void writeStoredNQuads(const QuadReader& reader, const std::optional<Term>& graph, const TextSink& out) {
  QuadPattern pattern;
  if (graph) {
    pattern.g = graph->text.empty() ? std::optional<TermId>(kNoTerm) : reader.idOf(*graph);
    if (!pattern.g) return;
  }
  QuadCursor cursor = reader.scan(pattern, QuadOrder::Gspo);
  for (QuadIds ids; cursor.next(ids);)
    out(toNQuads({reader.termOf(ids.s), reader.termOf(ids.p), reader.termOf(ids.o),
                  graph ? Term::iri("") : reader.termOf(ids.g)}));
}

}  // namespace cluxel::rdf
