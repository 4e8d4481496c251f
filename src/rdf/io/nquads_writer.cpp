// SPDX-License-Identifier: Apache-2.0
// Sorted N-Quads, with the labels of the store or canonical ones.
#include <unordered_map>
#include <utility>
#include <vector>

#include "rdf/io/canonical_labels.hpp"
#include "rdf/io/ntriples_text.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/io/sorted_subjects.hpp"

namespace cluxel::rdf {

namespace {

using Labels = std::map<std::string, std::string>;

constexpr std::size_t kMostKnown = 4096;  ///< graphs or texts; then they are read anew

/// Asks a filter once for each graph.
class KeptGraphs {
 public:
  KeptGraphs(const QuadReader& reader, const GraphFilter& keep) : reader_(reader), keep_(keep) {}

  bool has(TermId graph) {
    if (!keep_) return true;
    const auto known = kept_.find(graph);
    if (known != kept_.end()) return known->second;
    if (kept_.size() == kMostKnown) kept_.clear();
    return kept_.emplace(graph, keep_(reader_.termOf(graph))).first->second;
  }

 private:
  const QuadReader& reader_;
  const GraphFilter& keep_;
  std::unordered_map<TermId, bool> kept_;
};

/// The texts of terms, blank nodes with the labels that they are to have.
class LabelledTexts {
 public:
  LabelledTexts(const QuadReader& reader, const Labels& labels) : reader_(reader), labels_(labels) {}

  void append(std::string& text, TermId id) const {
    const TermView term = reader_.viewOf(id);
    if (term.kind != TermKind::BlankNode || labels_.empty()) return appendNTriples(text, term);
    const auto label = labels_.find(std::string(term.text));  // none when nothing is written about the node
    text.append("_:").append(label == labels_.end() ? term.text : std::string_view(label->second));
  }
  /// Of graphs and predicates, which come again and again.
  const std::string& of(TermId id) {
    const auto known = known_.find(id);
    if (known != known_.end()) return known->second;
    if (known_.size() == kMostKnown) known_.clear();
    std::string& text = known_[id];
    append(text, id);
    return text;
  }

 private:
  const QuadReader& reader_;
  const Labels& labels_;
  std::unordered_map<TermId, std::string> known_;
};

void writeSorted(const QuadReader& reader, const TextSink& out, const GraphFilter& keep, const Labels& labels,
                 std::size_t sort_bytes) {
  KeptGraphs kept(reader, keep);
  LabelledTexts texts(reader, labels);
  SortedSubjects subjects(reader, std::nullopt);
  SortedRecords ends(sort_bytes);  // of lines, behind the subject
  std::string text;
  const auto append_key = [&](std::string& key, TermId subject) {
    texts.append(key, subject);
    key += ' ';
  };
  const auto write_quads = [&](std::string_view start, TermId subject) {
    subjects.forEachQuadOf(subject, [&](const QuadIds& quad) {
      if (!kept.has(quad.g)) return;
      text.assign(texts.of(quad.p)) += ' ';
      texts.append(text, quad.o);
      if (quad.g != kNoTerm) (text += ' ') += texts.of(quad.g);
      ends.add(text += " .\n");
    });
    ends.drain([&](std::string_view end) { out(text.assign(start).append(end)); });
  };
  subjects.forEach(append_key, write_quads, sort_bytes);
}

/// The quads that name blank nodes, in the order of the store.
std::vector<Quad> quadsWithBlankNodes(const QuadReader& reader, const GraphFilter& keep) {
  std::vector<Quad> quads;
  KeptGraphs kept(reader, keep);
  TermId last_subject = kNoTerm, last_graph = kNoTerm;
  bool is_subject_blank = false, is_graph_blank = false;
  const auto isBlank = [&](TermId term) { return reader.viewOf(term).kind == TermKind::BlankNode; };
  QuadCursor cursor = reader.scan({}, QuadOrder::Spog);
  for (QuadIds ids; cursor.next(ids);) {
    if (std::exchange(last_subject, ids.s) != ids.s) is_subject_blank = isBlank(ids.s);
    if (std::exchange(last_graph, ids.g) != ids.g) is_graph_blank = isBlank(ids.g);
    if (!is_subject_blank && !is_graph_blank && !isBlank(ids.o)) continue;
    if (kept.has(ids.g))
      quads.push_back({reader.termOf(ids.s), reader.termOf(ids.p), reader.termOf(ids.o), reader.termOf(ids.g)});
  }
  return quads;
}

}  // namespace

void writeSortedNQuads(const QuadReader& reader, const TextSink& out, const GraphFilter& keep, std::size_t sort_bytes) {
  writeSorted(reader, out, keep, {}, sort_bytes);
}

bool writeCanonicalNQuads(const QuadReader& reader, const TextSink& out, const GraphFilter& keep,
                          std::size_t sort_bytes) {
  const auto [labels, has_blanks] = [&] {
    const std::vector<Quad> quads = quadsWithBlankNodes(reader, keep);
    return std::pair(canonicalLabels(quads), !quads.empty());
  }();
  writeSorted(reader, out, keep, labels, sort_bytes);
  return !labels.empty() || !has_blanks;
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
