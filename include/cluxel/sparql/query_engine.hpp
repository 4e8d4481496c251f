// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Query over a quad store: prepare, run, explain.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/term.hpp"
#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

/// What the default graph of a query without FROM is.
enum class DefaultGraph {
  UnionButHistory,  ///< all graphs but clx's history graph, each triple once
  Unnamed           ///< strictly the unnamed graph, as the W3C tests want it
};

/// What a query may use up; 0 or absent means no limit. Exceeding one throws Error (BudgetExceeded), never half
/// answers.
struct QueryBudget {
  std::optional<std::chrono::milliseconds> deadline = std::nullopt;  ///< from the start of run
  std::uint64_t max_rows = 0;                                        ///< rows of the answer
  std::uint64_t max_work_rows = 0;                                   ///< rows passed between operators in all
  std::uint64_t max_memory_bytes = 4ull << 30;                       ///< held by joins, sorts, groups and the answer
};

struct QueryOptions {
  DefaultGraph default_graph = DefaultGraph::UnionButHistory;
  QueryBudget budget = {};
  std::string base_iri = {};
  /// Names the query in diagnostics.
  std::string source_name = "query";
  /// Graphs for the default graph and the named graphs in place of FROM and FROM NAMED (the protocol's parameters).
  std::vector<std::string> default_graphs = {}, named_graphs = {};
  /// Seeds RAND, UUID and the labels of new blank nodes; absent: different in every run.
  std::optional<std::uint64_t> seed = std::nullopt;
  /// The time NOW() gives, microseconds since 1970 UTC; absent: the clock at the start of run.
  std::optional<std::int64_t> now_us = std::nullopt;
  /// SERVICE is refused but for these: the endpoint's IRI, and the store on this machine that answers for it. The
  /// readers must outlive the query. Nothing is ever asked over a network.
  std::map<std::string, const QuadReader*> services = {};
  bool refuse_volatile = false;  ///< rules: BNODE, RAND, NOW, UUID, cuts of unsorted rows are errors, history is hidden
};

using Binding = std::pair<std::string, Term>;  ///< a variable's name without '?', and its value

/// A query parsed and planned once for one snapshot, run many times. Not thread-safe; the reader must outlive it.
class PreparedQuery {
 public:
  struct Impl;
  /// `parameters`: variables that every run() binds; they act as constants everywhere in the query.
  /// Throws InputError with line, column and hint on a faulty query.
  PreparedQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options = {},
                const std::vector<std::string>& parameters = {});
  PreparedQuery(PreparedQuery&&) noexcept;
  PreparedQuery& operator=(PreparedQuery&&) noexcept;
  ~PreparedQuery();

  ast::QueryForm form() const;
  const std::vector<std::string>& variables() const;  ///< of a SELECT, in order
  /// The sink is called only when the answer is whole: a budget that runs out leaves it untouched.
  void run(ResultSink& sink, const std::vector<Binding>& bindings = {});
  QueryResult evaluate(const std::vector<Binding>& bindings = {});
  /// Whether there is a solution (ASK's answer): stops at the first.
  bool ask(const std::vector<Binding>& bindings = {});
  /// The plan as text; after a run with the actual rows beside the estimates.
  std::string explain() const;

 private:
  std::unique_ptr<Impl> impl_;
};

void runQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options, ResultSink& sink);
QueryResult evaluateQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options = {});

/// Runs the query and gives its plan with estimated and actual rows.
std::string explainQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options = {});
/// For a query without answers: the pattern that left nothing, in words; empty when there are answers.
std::string whyEmpty(const QuadReader& reader, std::string_view text, const QueryOptions& options = {},
                     const std::vector<Binding>& bindings = {});
/// Warnings: classes, properties and graphs that the store does not know, with "did you mean".
std::vector<Diagnostic> checkQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options = {});

}  // namespace cluxel
