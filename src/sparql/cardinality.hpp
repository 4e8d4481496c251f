// SPDX-License-Identifier: Apache-2.0
// How many rows a pattern gives, from the index counts and the statistics of predicates.
#pragma once

#include <unordered_map>

#include "sparql/algebra.hpp"
#include "sparql/runtime.hpp"

namespace cluxel::sparql {

class Cardinality {
 public:
  Cardinality(const QuadReader& reader, const Dataset& dataset) : reader_(reader), dataset_(dataset) {}

  /// Quads that fit the constants of a pattern.
  double matches(const TripleNode& pattern);
  /// Rows per solution in which the slots of `bound` have values.
  double fanOut(const TripleNode& pattern, const SlotSet& bound);
  /// Quads of a predicate.
  double quadsOf(ValueId predicate) {
    return predicate < kFirstComputed ? static_cast<double>(statistics(predicate).quads) : 0;
  }
  /// Rows of a node by itself.
  double rows(const Node& node);

 private:
  double pathRows(const TripleNode& pattern, const SlotSet& bound);
  double joinRows(const Node& node);

  const QuadReader& reader_;
  const Dataset& dataset_;
  std::unordered_map<const TripleNode*, double> known_;
  std::unordered_map<TermId, QuadReader::PredicateStatistics> statistics_;
  const QuadReader::PredicateStatistics& statistics(TermId predicate);
};

}  // namespace cluxel::sparql
