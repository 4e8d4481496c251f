// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Query over a quad store: preparation, execution, query plans.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/error.hpp"
#include "cluxel/term.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/results/result_table.hpp"

namespace cluxel::sparql {

/// The default graph of a query without FROM.
enum class DefaultGraph {
  UnionButHistory,  ///< the union of all graphs but history, without duplicate triples
  Unnamed           ///< the unnamed graph only, as in the W3C tests
};

/// The resource limits of a query or update; 0 or absent means unlimited. They cover parsing, planning, evaluation and
/// the calls of the result sink. Exceeding one throws Error (BudgetExceeded); partial results are never returned.
struct QueryBudget {
  std::optional<std::chrono::milliseconds> deadline =
      std::nullopt;                             ///< of a run; the first run includes the preparation
  std::uint64_t max_rows = 0;                   ///< rows of the result
  std::uint64_t max_work_rows = 0;              ///< total rows passed between operators
  std::uint64_t max_memory_bytes = 4ull << 30;  ///< held by the query, its plan and its results
  /// Called every few thousand rows in the thread of the query. What it throws ends the query.
  std::function<void()> poll = {};
  bool is_of_update = false;  ///< errors then say that nothing was changed, not that there is no result
};

struct QueryOptions {
  DefaultGraph default_graph = DefaultGraph::UnionButHistory;
  QueryBudget budget = {};
  std::string base_iri = {};
  /// Prefixes that need no PREFIX line, such as mapPrefixes(); a PREFIX line overrides them.
  std::vector<std::pair<std::string, std::string>> prefixes = {};
  /// The name of the query in diagnostics.
  std::string source_name = "query";
  /// The default and named graphs, in place of FROM and FROM NAMED (the parameters of the SPARQL protocol).
  std::vector<std::string> default_graphs = {}, named_graphs = {};
  /// Seed of RAND, UUID and new blank node labels; if absent, each run uses a different one.
  std::optional<std::uint64_t> seed = std::nullopt;
  /// The value of NOW() in microseconds since 1970 UTC; if absent, the time at the start of run().
  std::optional<std::int64_t> now_us = std::nullopt;
  /// The permitted SERVICE endpoints, each mapped to a local store that answers in its place; all others are refused.
  /// The readers must outlive the query. No network access takes place.
  std::map<std::string, const rdf::QuadReader*> services = {};
  /// False: no index and no join by distances or ranges is used. The answers are the same; for comparisons.
  bool spatial_plans = true;
  bool refuse_volatile =
      false;  ///< for rules: BNODE, RAND, NOW, UUID and LIMIT over unsorted rows are errors; history is hidden
};

/// The prefixes of a map's vocabularies with their namespaces: clx, geo, geof, sosa, prov, rdf, rdfs, owl, xsd, skos.
const std::vector<std::pair<std::string, std::string>>& mapPrefixes();

using Binding = std::pair<std::string, Term>;  ///< a variable's name without '?' and its value

/// A query, parsed and planned once for one snapshot, that can be run repeatedly. Not thread-safe. The reader must
/// outlive it.
class PreparedQuery {
 public:
  struct Impl;
  /// `parameters` are variables bound by every run(); they act as constants throughout the query.
  /// Throws InputError with line, column and hint for a faulty query.
  PreparedQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options = {},
                const std::vector<std::string>& parameters = {});
  /// The same of a query that is parsed already.
  PreparedQuery(const rdf::QuadReader& reader, ast::Query query, const QueryOptions& options = {});
  PreparedQuery(PreparedQuery&&) noexcept;
  PreparedQuery& operator=(PreparedQuery&&) noexcept;
  ~PreparedQuery();

  ast::QueryForm form() const;
  const std::vector<std::string>& variables() const;  ///< of a SELECT, in order
  /// Classes, properties and graphs that the store does not contain, with suggestions; unknown functions and constant
  /// patterns that are no regular expressions.
  std::vector<Diagnostic> warnings() const;
  /// What the functions noted in the last run: geometries that could not be measured, coordinates that were left out.
  std::vector<Diagnostic> notes() const;
  /// Calls the sink only after the complete result is computed; it is not called when a budget is exceeded before. A
  /// deadline that passes during its calls ends them by an Error.
  void run(ResultSink& sink, const std::vector<Binding>& bindings = {});
  QueryResult evaluate(const std::vector<Binding>& bindings = {});
  /// True when there is a solution (the result of ASK); stops at the first.
  bool ask(const std::vector<Binding>& bindings = {});
  /// The plan as text; after a run, with actual and estimated row counts.
  std::string explain() const;
  /// The same as JSON in one line: {"operator", "estimated", "actual" (after a run), "inputs": [...]}.
  std::string explainJson() const;

 private:
  std::unique_ptr<Impl> impl_;
};

void runQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options, ResultSink& sink);
QueryResult evaluateQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options = {});

/// For a query without solutions: describes the part of the pattern that eliminated them. Empty when there are
/// solutions.
std::string whyEmpty(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options = {},
                     const std::vector<Binding>& bindings = {});
/// PreparedQuery::warnings() of a query without parameters.
std::vector<Diagnostic> checkQuery(const rdf::QuadReader& reader, std::string_view text,
                                   const QueryOptions& options = {});

}  // namespace cluxel::sparql
