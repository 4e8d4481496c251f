// SPDX-License-Identifier: Apache-2.0
// Constructs the RDF dataset of a query.
#include "sparql/exec/runtime.hpp"

#include "rdf/vocabulary.hpp"

namespace cluxel::sparql {
namespace {

std::vector<rdf::TermId> idsOf(const std::vector<Term>& graphs, const rdf::QuadReader& reader) {
  std::vector<rdf::TermId> ids;
  for (const Term& graph : graphs) {
    if (graph.text.empty()) {
      ids.push_back(rdf::kNoTerm);
    } else if (const auto id = reader.idOf(graph)) {
      ids.push_back(*id);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

GraphFilter anyOf(std::vector<rdf::TermId> graphs) {
  GraphFilter filter;
  filter.may_repeat = graphs.size() > 1;
  filter.kind = graphs.size() == 1 ? GraphFilter::Kind::One : GraphFilter::Kind::AnyOf;
  if (graphs.size() == 1) filter.graph = graphs.front();
  filter.graphs = std::move(graphs);
  return filter;
}

GraphFilter storeDefault(const QueryOptions& options, const std::vector<rdf::TermId>& stored,
                         const rdf::QuadReader& reader) {
  if (options.default_graph == DefaultGraph::Unnamed) return anyOf({rdf::kNoTerm});
  GraphFilter filter;
  const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  const bool has_history = history && std::binary_search(stored.begin(), stored.end(), *history);
  const std::size_t graphs = stored.size() - (has_history ? 1 : 0);
  filter.kind = has_history ? GraphFilter::Kind::AllBut : GraphFilter::Kind::Any;
  if (has_history) filter.graph = *history;
  filter.may_repeat = graphs > 1;
  return filter;
}

/// Excludes the history graph from queries whose results must not depend on it.
void hideHistory(Dataset& dataset, const rdf::QuadReader& reader) {
  const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  if (!history) return;
  std::erase(dataset.named, *history);
  GraphFilter& graphs = dataset.default_graph;
  const bool names_it = graphs.kind == GraphFilter::Kind::AnyOf || graphs.kind == GraphFilter::Kind::One;
  if (!names_it || !graphs.admits(*history)) return;
  std::erase(graphs.graphs, *history);
  graphs = anyOf(std::move(graphs.graphs));
}

std::vector<Term> irisOf(const std::vector<std::string>& texts) {
  std::vector<Term> terms;
  for (const std::string& text : texts) terms.push_back(Term::iri(text));
  return terms;
}

Dataset wholeDatasetOf(const ast::DatasetClause& clause, const QueryOptions& options, const rdf::QuadReader& reader) {
  ast::DatasetClause dataset_clause = clause;
  if (!options.default_graphs.empty() || !options.named_graphs.empty()) {
    dataset_clause.default_graphs = irisOf(options.default_graphs);
    dataset_clause.named_graphs = irisOf(options.named_graphs);
  }
  std::vector<rdf::TermId> stored = reader.graphs();
  std::sort(stored.begin(), stored.end());
  Dataset dataset;
  if (!dataset_clause.empty()) {
    // Graphs come from the store; nothing is fetched.
    dataset.default_graph = anyOf(idsOf(dataset_clause.default_graphs, reader));
    const std::vector<rdf::TermId> named = idsOf(dataset_clause.named_graphs, reader);
    std::set_intersection(named.begin(), named.end(), stored.begin(), stored.end(), std::back_inserter(dataset.named));
    return dataset;
  }
  dataset.default_graph = storeDefault(options, stored, reader);
  for (const rdf::TermId graph : stored) {
    if (graph != rdf::kNoTerm) dataset.named.push_back(graph);
  }
  return dataset;
}

}  // namespace

Dataset datasetOf(const ast::DatasetClause& clause, const QueryOptions& options, const rdf::QuadReader& reader) {
  Dataset dataset = wholeDatasetOf(clause, options, reader);
  if (options.refuse_volatile) hideHistory(dataset, reader);
  return dataset;
}

}  // namespace cluxel::sparql
