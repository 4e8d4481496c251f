// SPDX-License-Identifier: Apache-2.0
// Sorted N-Quads, with the labels of the store or canonical ones.
#include <algorithm>
#include <utility>
#include <vector>

#include "rdf/io/canonical_labels.hpp"
#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

namespace {

bool hasBlankNode(const Quad& quad) {
  return quad.subject.kind == TermKind::BlankNode || quad.object.kind == TermKind::BlankNode ||
         quad.graph.kind == TermKind::BlankNode;
}

template <typename Visit>
void forEachQuad(const QuadReader& reader, const std::function<bool(const Quad&)>& keep, const Visit& visit) {
  QuadCursor cursor = reader.scan({}, QuadOrder::Spog);
  for (QuadIds ids; cursor.next(ids);) {
    Quad quad{reader.termOf(ids.s), reader.termOf(ids.p), reader.termOf(ids.o), reader.termOf(ids.g)};
    if (!keep || keep(quad)) visit(std::move(quad));
  }
}

void writeSorted(std::vector<std::string> lines, const TextSink& out) {
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  for (const std::string& line : lines) out(line);
}

}  // namespace

void writeSortedNQuads(const QuadReader& reader, const TextSink& out, const std::function<bool(const Quad&)>& keep) {
  std::vector<std::string> lines;
  forEachQuad(reader, keep, [&](const Quad& quad) { lines.push_back(toNQuads(quad)); });
  writeSorted(std::move(lines), out);
}

bool writeCanonicalNQuads(const QuadReader& reader, const TextSink& out, const std::function<bool(const Quad&)>& keep) {
  std::vector<std::string> lines;
  std::vector<Quad> with_blanks;
  forEachQuad(reader, keep, [&](Quad quad) {
    if (hasBlankNode(quad))
      with_blanks.push_back(std::move(quad));
    else
      lines.push_back(toNQuads(quad));
  });
  const std::map<std::string, std::string> labels = canonicalLabels(with_blanks);
  for (Quad& quad : with_blanks) {
    for (Term* term : {&quad.subject, &quad.object, &quad.graph})
      if (term->kind == TermKind::BlankNode && !labels.empty()) term->text = labels.at(term->text);
    lines.push_back(toNQuads(quad));
  }
  writeSorted(std::move(lines), out);
  return !labels.empty() || with_blanks.empty();
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
