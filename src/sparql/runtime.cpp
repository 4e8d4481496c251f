// SPDX-License-Identifier: Apache-2.0
// Datasets and budgets.
#include "sparql/runtime.hpp"

#include "cluxel/knowledge/vocabulary.hpp"

namespace cluxel::sparql {
namespace {

constexpr std::uint64_t kRowsBetweenChecks = 4096;

std::vector<TermId> idsOf(const std::vector<Term>& graphs, const QuadReader& reader) {
  std::vector<TermId> ids;
  for (const Term& graph : graphs) {
    if (graph.text.empty()) {
      ids.push_back(kNoTerm);
    } else if (const auto id = reader.idOf(graph)) {
      ids.push_back(*id);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

GraphFilter anyOf(std::vector<TermId> graphs) {
  GraphFilter filter;
  filter.may_repeat = graphs.size() > 1;
  filter.kind = graphs.size() == 1 ? GraphFilter::Kind::One : GraphFilter::Kind::AnyOf;
  if (graphs.size() == 1) filter.graph = graphs.front();
  filter.graphs = std::move(graphs);
  return filter;
}

GraphFilter storeDefault(const QueryOptions& options, const std::vector<TermId>& stored, const QuadReader& reader) {
  if (options.default_graph == DefaultGraph::Unnamed) return anyOf({kNoTerm});
  GraphFilter filter;
  const auto history = reader.idOf(Term::iri(vocabulary::kGraphHistory));
  const bool has_history = history && std::binary_search(stored.begin(), stored.end(), *history);
  const std::size_t graphs = stored.size() - (has_history ? 1 : 0);
  filter.kind = has_history ? GraphFilter::Kind::AllBut : GraphFilter::Kind::Any;
  if (has_history) filter.graph = *history;
  filter.may_repeat = graphs > 1;
  return filter;
}

std::vector<Term> irisOf(const std::vector<std::string>& texts) {
  std::vector<Term> terms;
  for (const std::string& text : texts) terms.push_back(Term::iri(text));
  return terms;
}

}  // namespace

Dataset datasetOf(const ast::DatasetClause& clause, const QueryOptions& options, const QuadReader& reader) {
  ast::DatasetClause wanted = clause;
  if (!options.default_graphs.empty() || !options.named_graphs.empty()) {
    wanted.default_graphs = irisOf(options.default_graphs);
    wanted.named_graphs = irisOf(options.named_graphs);
  }
  std::vector<TermId> stored = reader.graphs();
  std::sort(stored.begin(), stored.end());
  Dataset dataset;
  if (!wanted.empty()) {
    // Only graphs of the store: nothing is fetched.
    dataset.default_graph = anyOf(idsOf(wanted.default_graphs, reader));
    const std::vector<TermId> named = idsOf(wanted.named_graphs, reader);
    std::set_intersection(named.begin(), named.end(), stored.begin(), stored.end(), std::back_inserter(dataset.named));
    return dataset;
  }
  dataset.default_graph = storeDefault(options, stored, reader);
  for (const TermId graph : stored) {
    if (graph != kNoTerm) dataset.named.push_back(graph);
  }
  return dataset;
}

void Guard::start(const QueryBudget& budget) {
  budget_ = budget;
  constexpr auto kNoLimit = ~std::uint64_t{0};
  deadline_ = std::chrono::steady_clock::now() + budget.deadline.value_or(std::chrono::milliseconds(0));
  work_rows_ = 0;
  bytes_ = 0;
  most_work_rows_ = budget.max_work_rows == 0 ? kNoLimit : budget.max_work_rows;
  most_answer_rows_ = budget.max_rows == 0 ? kNoLimit : budget.max_rows;
  most_bytes_ = budget.max_memory_bytes == 0 ? kNoLimit : budget.max_memory_bytes;
  next_check_ = std::min(kRowsBetweenChecks, most_work_rows_);
  if (budget.deadline && budget.deadline->count() <= 0) refuse("time");
}

void Guard::check() {
  if (work_rows_ > most_work_rows_) refuse("rows");
  if (budget_.deadline && std::chrono::steady_clock::now() > deadline_) refuse("time");
  next_check_ = std::min(work_rows_ + kRowsBetweenChecks, most_work_rows_ + (most_work_rows_ == ~std::uint64_t{0} ? 0 : 1));
}

void Guard::refuse(const char* what) const {
  throw Error(ExitCode::BudgetExceeded, std::string("query: its budget of ") + what +
                                            " is used up; no answer is given. Narrow the query or raise the budget");
}

}  // namespace cluxel::sparql
