// SPDX-License-Identifier: Apache-2.0
// Collects results as values and replays them into sinks.
#include "sparql/results/result_table.hpp"

#include <algorithm>

namespace cluxel::sparql {

namespace {

class TableTerms : public TermLookup {
 public:
  explicit TableTerms(const ResultTable& table) : table_(table) {}
  rdf::TermView view(ResultId id) const override { return rdf::TermView::of(table_.terms[id - 1]); }

 private:
  const ResultTable& table_;
};

}  // namespace

void ResultCollector::beginSolutions(std::span<const std::string> variables, const TermLookup& terms) {
  result_.kind = QueryResult::Kind::Solutions;
  result_.table.variables.assign(variables.begin(), variables.end());
  terms_ = &terms;
}

void ResultCollector::rows(std::span<const ResultId> cells, std::size_t count) {
  ResultTable& table = result_.table;
  table.row_count += count;
  for (const ResultId id : cells) {
    if (id == 0) {
      table.cells.push_back(0);
      continue;
    }
    const auto [place, is_new] = cell_of_.try_emplace(id, static_cast<std::uint32_t>(table.terms.size() + 1));
    if (is_new) table.terms.push_back(terms_->view(id).toTerm());
    table.cells.push_back(place->second);
  }
}

void ResultCollector::boolean(bool value) {
  result_.kind = QueryResult::Kind::Boolean;
  result_.boolean = value;
}

void ResultCollector::beginGraph() {
  result_.kind = QueryResult::Kind::Graph;
}

void ResultCollector::triple(const rdf::TermView& subject, const rdf::TermView& predicate,
                             const rdf::TermView& object) {
  result_.graph.push_back({subject.toTerm(), predicate.toTerm(), object.toTerm(), {}});
}

void replay(const QueryResult& result, ResultSink& sink) {
  const TableTerms terms(result.table);
  switch (result.kind) {
    case QueryResult::Kind::Solutions:
      sink.beginSolutions(result.table.variables, terms);
      sink.rows(result.table.cells, result.table.row_count);
      break;
    case QueryResult::Kind::Boolean:
      sink.boolean(result.boolean);
      break;
    case QueryResult::Kind::Graph:
      sink.beginGraph();
      for (const Quad& quad : result.graph)
        sink.triple(rdf::TermView::of(quad.subject), rdf::TermView::of(quad.predicate), rdf::TermView::of(quad.object));
      break;
  }
  sink.end();
}

}  // namespace cluxel::sparql
