// SPDX-License-Identifier: Apache-2.0
// The row loop shared by the JSON, XML, CSV and TSV writers.
#include "sparql/results/solution_writer.hpp"

namespace cluxel::sparql {

SolutionWriter::SolutionWriter(TextSink out, AppendTerm append_term)
    : buffer_(std::move(out)), append_term_(append_term), cache_(kCached) {}

void SolutionWriter::beginSolutions(std::span<const std::string> variables, const TermLookup& terms) {
  variables_.assign(variables.begin(), variables.end());
  terms_ = &terms;
  solutions_ = true;
  header();
}

void SolutionWriter::rows(std::span<const ResultId> cells, std::size_t count) {
  const std::size_t width = variables_.size();
  for (std::size_t row = 0; row < count; ++row) {
    beginRow();
    for (std::size_t column = 0; column < width; ++column) {
      const ResultId id = cells[row * width + column];
      beginCell(column, id != 0);
      if (id == 0) continue;
      appendCell(id);
      endCell();
    }
    endRow();
    buffer_.flushWhenFull();
  }
}

void SolutionWriter::appendCell(ResultId id) {
  Cached& place = cache_[id % kCached];
  if (place.id != id) {
    place.id = id;
    place.text.clear();
    append_term_(place.text, terms_->view(id));
  }
  buffer_.text().append(place.text);
}

void SolutionWriter::beginGraph() {
  variables_ = {"subject", "predicate", "object"};
  solutions_ = true;
  header();
}

void SolutionWriter::triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) {
  beginRow();
  std::size_t column = 0;
  for (const rdf::TermView* term : {&subject, &predicate, &object}) {
    beginCell(column++, true);
    append_term_(buffer_.text(), *term);
    endCell();
  }
  endRow();
  buffer_.flushWhenFull();
}

void SolutionWriter::end() {
  footer();
  buffer_.flush();
}

}  // namespace cluxel::sparql
