// SPDX-License-Identifier: Apache-2.0
// The state shared by the operators of a run: store, dataset, budgets, parameters.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "sparql/exec/batch.hpp"
#include "sparql/exec/guard.hpp"
#include "sparql/functions/functions.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::sparql {

/// The graphs that a pattern reads.
struct GraphFilter {
  enum class Kind : std::uint8_t { Any, AllBut, One, AnyOf } kind = Kind::Any;
  rdf::TermId graph = rdf::kNoTerm;  ///< of AllBut and One
  std::vector<rdf::TermId> graphs;   ///< of AnyOf, ascending
  bool may_repeat = true;            ///< a triple may occur in several graphs

  bool admits(rdf::TermId candidate) const {
    switch (kind) {
      case Kind::Any:
        return true;
      case Kind::AllBut:
        return candidate != graph;
      case Kind::One:
        return candidate == graph;
      case Kind::AnyOf:
        return std::binary_search(graphs.begin(), graphs.end(), candidate);
    }
    return false;
  }
};

/// The RDF dataset of a query.
struct Dataset {
  GraphFilter default_graph;
  std::vector<rdf::TermId> named;  ///< ascending
};

/// The dataset given by the FROM clauses, else by the options.
Dataset datasetOf(const ast::DatasetClause& clause, const QueryOptions& options, const rdf::QuadReader& reader);

struct Runtime {
  Runtime(const rdf::QuadReader& quad_reader, QueryTerms& query_terms, FunctionContext& function_context,
          const Dataset& query_dataset, std::size_t slots, std::size_t exists_count)
      : reader(quad_reader),
        terms(query_terms),
        functions(function_context),
        dataset(query_dataset),
        slot_count(slots),
        parameters(slots, kUnbound),
        exists_results(exists_count) {}

  const rdf::QuadReader& reader;
  QueryTerms& terms;
  FunctionContext& functions;
  const Dataset& dataset;
  Guard guard;
  std::size_t charged_for_terms = 0;
  std::size_t slot_count;
  std::vector<ValueId> parameters;  ///< by slot: the initial values of every solution
  /// For each Exists of the query, its results for the rows of the current batch.
  std::vector<std::vector<std::uint8_t>> exists_results;

  /// Charges the terms computed since the last call.
  void chargeForTerms() {
    const std::size_t bytes = terms.computedBytes();
    if (bytes > charged_for_terms) guard.charge(bytes - charged_for_terms);
    charged_for_terms = bytes;
  }
};

/// Evaluates expressions for the rows of a batch.
class Evaluator {
 public:
  explicit Evaluator(Runtime& runtime) : runtime_(runtime) {}
  Value value(const Expr& expression, const Batch& batch, std::size_t row);
  /// The effective boolean value; none for an error.
  std::optional<bool> truth(const Expr& expression, const Batch& batch, std::size_t row);

 private:
  Value compared(const Expr& expression, const Batch& batch, std::size_t row);
  Value membership(const Expr& expression, const Batch& batch, std::size_t row);
  Value arithmetic(const Expr& expression, const Batch& batch, std::size_t row);
  Value called(const Expr& expression, const Batch& batch, std::size_t row);
  void countText(std::size_t bytes);

  Runtime& runtime_;
};

}  // namespace cluxel::sparql
