// SPDX-License-Identifier: Apache-2.0
// Answers of queries: as a stream into a sink (what writers read), and as values (what tests and the library's callers
// read). The evaluator hands out ids; text is looked up only where somebody wants to see it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/term.hpp"
#include "cluxel/sparql/ast.hpp"

namespace cluxel {

/// The number of a term within one answer: the same id is the same term. 0 is unbound. Store ids and the ids of
/// computed terms share this number space as the evaluator chooses.
using ResultId = std::uint32_t;

/// Looks ids of an answer up.
class TermLookup {
 public:
  virtual ~TermLookup() = default;
  /// `id` is not 0. The text is valid until the next call of view().
  virtual TermView view(ResultId id) const = 0;
  /// Ids whose views will be asked for next, 0 among them: lets the store read them together. Changes no answer.
  virtual void expect(std::span<const ResultId> /*ids*/) const {}
};

/// Receives one answer: beginSolutions rows* end, or boolean end, or beginGraph triple* end.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  /// `terms` outlives the answer.
  virtual void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) = 0;
  /// `count` rows, row by row: count x variables ids. Batches of some hundred rows spare calls; any size will do.
  virtual void rows(std::span<const ResultId> cells, std::size_t count) = 0;
  virtual void boolean(bool value) = 0;
  virtual void beginGraph() = 0;
  /// Triples of CONSTRUCT and DESCRIBE: without duplicates.
  virtual void triple(const TermView& subject, const TermView& predicate, const TermView& object) = 0;
  virtual void end() = 0;
};

/// Solutions as values: cells are numbers of `terms` plus one, 0 for unbound.
struct ResultTable {
  std::vector<std::string> variables;
  std::vector<Term> terms;
  std::vector<std::uint32_t> cells;  ///< row by row
  std::size_t row_count = 0;

  /// Null when unbound.
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
  std::vector<Quad> graph;  ///< triples: the graph term is the default graph

  bool operator==(const QueryResult&) const = delete;  ///< blank nodes: compare with sameResults()
};

/// Keeps an answer as a value.
class ResultCollector : public ResultSink {
 public:
  void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) override;
  void rows(std::span<const ResultId> cells, std::size_t count) override;
  void boolean(bool value) override;
  void beginGraph() override;
  void triple(const TermView& subject, const TermView& predicate, const TermView& object) override;
  void end() override {}

  QueryResult take() { return std::move(result_); }

 private:
  QueryResult result_;
  const TermLookup* terms_ = nullptr;
  std::map<ResultId, std::uint32_t> cell_of_;
};

/// Plays a kept answer into a sink.
void replay(const QueryResult& result, ResultSink& sink);

}  // namespace cluxel
