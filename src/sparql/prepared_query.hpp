// SPDX-License-Identifier: Apache-2.0
// What a prepared query holds.
#pragma once

#include "cluxel/sparql/parser.hpp"
#include "cluxel/sparql/query_engine.hpp"
#include "sparql/operators.hpp"

namespace cluxel {

struct PreparedQuery::Impl {
  Impl(const QuadReader& quad_reader, std::string_view text, const QueryOptions& query_options,
       const std::vector<std::string>& parameters);

  void setParameters(const std::vector<Binding>& bindings);
  /// Sets parameters, clock and budgets for a run, and opens the plan.
  void begin(const std::vector<Binding>& bindings);
  void runSelect(ResultSink& sink);
  void runGraph(ResultSink& sink);
  bool hasSolution();

  const QuadReader& reader;
  QueryOptions options;
  sparql::QueryTerms terms;
  ast::Query query;
  sparql::Dataset dataset;
  sparql::AlgebraQuery algebra;
  sparql::OperatorPtr plan;
  std::vector<std::string> variables;
  std::vector<std::pair<std::string, sparql::Slot>> parameter_slots;
  sparql::FunctionContext functions;
  std::unique_ptr<sparql::Runtime> runtime;
  sparql::Guard::Usage used_by_services;  ///< SERVICE is answered once, and counts in every run
  std::size_t mark = 0;
  bool has_run = false;
};

}  // namespace cluxel
