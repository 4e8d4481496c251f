// SPDX-License-Identifier: Apache-2.0
// The state of a prepared query.
#pragma once

#include "sparql/exec/operators/operators.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::sparql {

struct PreparedQuery::Impl {
  using Parse = std::function<ast::Query(Guard&)>;
  Impl(const rdf::QuadReader& quad_reader, const Parse& parse, const QueryOptions& query_options,
       const std::vector<std::string>& parameters);

  Impl(const rdf::QuadReader& quad_reader, std::string_view text, const QueryOptions& query_options,
       const std::vector<std::string>& parameters);

  void setParameters(const std::vector<Binding>& bindings);
  /// Initialises parameters, clock and budgets for a run, and opens the plan.
  void begin(const std::vector<Binding>& bindings);
  void runSelect(ResultSink& sink);
  void runGraph(ResultSink& sink);
  bool hasSolution();

  const rdf::QuadReader& reader;
  QueryOptions options;
  Guard preparing;  ///< counts what parsing, SERVICE and planning use; the first run goes on from it
  QueryTerms terms;
  ast::Query query;
  Dataset dataset;
  AlgebraQuery algebra;
  OperatorPtr plan;
  std::vector<std::string> variables;
  std::vector<std::pair<std::string, Slot>> parameter_slots;
  FunctionContext functions;
  std::unique_ptr<Runtime> runtime;
  Guard::Usage used_before;  ///< by the preparation; charged to every run, its time without SERVICE to the first only
  std::size_t mark = 0;
  bool has_run = false;
};

}  // namespace cluxel::sparql
