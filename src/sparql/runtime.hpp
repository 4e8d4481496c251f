// SPDX-License-Identifier: Apache-2.0
// What the operators of one run share: the store, the dataset, budgets, parameters.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "cluxel/sparql/query_engine.hpp"
#include "sparql/batch.hpp"
#include "sparql/functions.hpp"
#include "sparql/guard.hpp"

namespace cluxel::sparql {

/// Which graphs a pattern may take its quads from.
struct GraphFilter {
  enum class Kind : std::uint8_t { Any, AllBut, One, AnyOf } kind = Kind::Any;
  TermId graph = kNoTerm;      ///< of AllBut and One
  std::vector<TermId> graphs;  ///< of AnyOf, ascending
  bool may_repeat = true;      ///< one triple may come from several graphs

  bool admits(TermId candidate) const {
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
  std::vector<TermId> named;  ///< ascending
};

/// The dataset by the query's FROM clauses, else by the options.
Dataset datasetOf(const ast::DatasetClause& clause, const QueryOptions& options, const QuadReader& reader);

struct Runtime {
  Runtime(const QuadReader& quad_reader, QueryTerms& query_terms, FunctionContext& function_context,
          const Dataset& query_dataset, std::size_t slots, std::size_t exists_count)
      : reader(quad_reader),
        terms(query_terms),
        functions(function_context),
        dataset(query_dataset),
        slot_count(slots),
        parameters(slots, kUnbound),
        exists_results(exists_count) {}

  const QuadReader& reader;
  QueryTerms& terms;
  FunctionContext& functions;
  const Dataset& dataset;
  Guard guard;
  std::size_t charged_for_terms = 0;
  std::size_t slot_count;
  std::vector<ValueId> parameters;  ///< by slot: what every solution starts with
  /// For each Exists of the query its answers for the rows of the batch at hand.
  std::vector<std::vector<std::uint8_t>> exists_results;

  /// For the terms that were computed since.
  void chargeForTerms() {
    const std::size_t bytes = terms.computedBytes();
    if (bytes > charged_for_terms) guard.charge(bytes - charged_for_terms);
    charged_for_terms = bytes;
  }
};

/// Computes expressions for rows of a batch.
class Evaluator {
 public:
  explicit Evaluator(Runtime& runtime) : runtime_(runtime) {}
  Value value(const Expr& expression, const Batch& batch, std::size_t row);
  /// The effective boolean value; nothing for an error.
  std::optional<bool> truth(const Expr& expression, const Batch& batch, std::size_t row);

 private:
  Value compared(const Expr& expression, const Batch& batch, std::size_t row);
  Value membership(const Expr& expression, const Batch& batch, std::size_t row);
  Value arithmetic(const Expr& expression, const Batch& batch, std::size_t row);
  Value called(const Expr& expression, const Batch& batch, std::size_t row);

  Runtime& runtime_;
};

}  // namespace cluxel::sparql
