// SPDX-License-Identifier: Apache-2.0
// Cardinality estimates of patterns, from index counts and predicate statistics.
#pragma once

#include <unordered_map>

#include "sparql/algebra/algebra.hpp"
#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

class Cardinality {
 public:
  Cardinality(const rdf::QuadReader& reader, const Dataset& dataset) : reader_(reader), dataset_(dataset) {}

  /// The number of quads that match the constants of a pattern.
  double matches(const TripleNode& pattern);
  /// Rows per input solution that binds the slots of `bound`.
  double fanOut(const TripleNode& pattern, const SlotSet& bound);
  /// The number of quads of a predicate.
  double quadsOf(ValueId predicate);
  /// Rows of a node evaluated on its own.
  double rows(const Node& node);

 private:
  double pathRows(const TripleNode& pattern, const SlotSet& bound);
  double joinRows(const Node& node);

  const rdf::QuadReader& reader_;
  const Dataset& dataset_;
  std::unordered_map<const TripleNode*, double> known_;
  std::unordered_map<rdf::TermId, rdf::QuadReader::PredicateStatistics> statistics_;
  const rdf::QuadReader::PredicateStatistics& statistics(rdf::TermId predicate);
};

}  // namespace cluxel::sparql
