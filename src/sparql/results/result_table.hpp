// SPDX-License-Identifier: Apache-2.0
// Query results, as a stream into a sink (for writers) and as values (for callers and tests). Cells are ids; their text
// is looked up on demand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/term.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/syntax/ast.hpp"

namespace cluxel::sparql {

/// The id of a term within one result; equal ids are equal terms, 0 is unbound. Ids of stored and of computed terms
/// share one number range.
using ResultId = std::uint32_t;

/// Maps the ids of a result to terms.
class TermLookup {
 public:
  virtual ~TermLookup() = default;
  /// `id` must not be 0. The view is valid until the next call of view().
  virtual rdf::TermView view(ResultId id) const = 0;
};

/// Receives one result. Call sequence: beginSolutions rows* end, or boolean end, or beginGraph triple* end.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  /// `terms` remains valid until end().
  virtual void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) = 0;
  /// A batch of `count` rows in row-major order: count x variables ids.
  virtual void rows(std::span<const ResultId> cells, std::size_t count) = 0;
  virtual void boolean(bool value) = 0;
  virtual void beginGraph() = 0;
  /// The triples of CONSTRUCT and DESCRIBE, without duplicates.
  virtual void triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) = 0;
  virtual void end() = 0;
};

/// Discards the result.
class NoSink : public ResultSink {
 public:
  void beginSolutions(std::span<const std::string>, const TermLookup&) override {}
  void rows(std::span<const ResultId>, std::size_t) override {}
  void boolean(bool) override {}
  void beginGraph() override {}
  void triple(const rdf::TermView&, const rdf::TermView&, const rdf::TermView&) override {}
  void end() override {}
};

/// Solutions as values: a cell is an index into `terms` plus one, or 0 for unbound.
struct ResultTable {
  std::vector<std::string> variables;
  std::vector<Term> terms;
  std::vector<std::uint32_t> cells;  ///< row-major
  std::size_t row_count = 0;

  /// Null if unbound.
  const Term* at(std::size_t row, std::size_t column) const {
    const std::uint32_t cell = cells[row * variables.size() + column];
    return cell == 0 ? nullptr : &terms[cell - 1];
  }
};

struct QueryResult {
  enum class Kind : std::uint8_t { Solutions, Boolean, Graph };
  Kind kind = Kind::Solutions;
  ResultTable table;
  bool boolean = false;
  std::vector<Quad> graph;  ///< triples; the graph term is the default graph

  bool operator==(const QueryResult&) const = delete;  ///< equality up to blank node labels needs an isomorphism test
};

/// Collects a result as a value.
class ResultCollector : public ResultSink {
 public:
  void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) override;
  void rows(std::span<const ResultId> cells, std::size_t count) override;
  void boolean(bool value) override;
  void beginGraph() override;
  void triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) override;
  void end() override {}

  QueryResult take() { return std::move(result_); }

 private:
  QueryResult result_;
  const TermLookup* terms_ = nullptr;
  std::map<ResultId, std::uint32_t> cell_of_;
};

/// Replays a collected result into a sink.
void replay(const QueryResult& result, ResultSink& sink);

}  // namespace cluxel::sparql
