// SPDX-License-Identifier: Apache-2.0
// Where a query's answer goes: rows, a truth value or triples, one call at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cluxel/knowledge/term.hpp"

namespace cluxel {

/// Turns the keys of one result into terms. Terms stay valid until the result ends.
class TermSource {
 public:
  virtual ~TermSource() = default;
  virtual const Term& termOfKey(std::uint32_t key) = 0;
};

/// One solution. Terms are decoded only when asked for; equal keys within one result mean equal terms, so that a
/// writer may keep what it wrote for a key.
class ResultRow {
 public:
  ResultRow(std::span<const std::uint32_t> keys, TermSource& terms) : keys_(keys), terms_(&terms) {}
  std::size_t size() const { return keys_.size(); }
  bool isBound(std::size_t column) const { return keys_[column] != 0; }
  std::uint32_t key(std::size_t column) const { return keys_[column]; }   ///< 0: unbound
  const Term& term(std::size_t column) const { return terms_->termOfKey(keys_[column]); }

 private:
  std::span<const std::uint32_t> keys_;
  TermSource* terms_;
};

/// Receives an answer. Nothing is called before the answer is whole: a budget that runs out leaves the sink untouched.
/// SELECT: beginRows, row*, end. ASK: truth, end. CONSTRUCT and DESCRIBE: beginGraph, triple*, end (no duplicates).
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  virtual void beginRows(const std::vector<std::string>& /*variables*/) {}
  virtual void row(const ResultRow& /*solution*/) {}
  virtual void truth(bool /*value*/) {}
  /// `prefixes` are the pairs (prefix, IRI) of the query, for Turtle.
  virtual void beginGraph(const std::vector<std::pair<std::string, std::string>>& /*prefixes*/) {}
  virtual void triple(const Term& /*subject*/, const Term& /*predicate*/, const Term& /*object*/) {}
  virtual void end() {}
};

}  // namespace cluxel
