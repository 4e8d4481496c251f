// SPDX-License-Identifier: Apache-2.0
// Prefetches the values used by expressions some rows ahead, so that their cache misses overlap.
#pragma once

#include <vector>

#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

class ValuesAhead {
 public:
  /// Collects the slots whose values the expression reads.
  void add(const Expr& expression);

  /// Must be called before each row of a batch, in order.
  void before(std::size_t row, const Batch& batch, const QueryTerms& terms) {
    if (row % kTogether == 0 && batch.rows - row >= kFewRows) expect(row, batch, terms);
  }

 private:
  static constexpr std::size_t kTogether = 64, kFewRows = 4;
  void expect(std::size_t row, const Batch& batch, const QueryTerms& terms) const;

  std::vector<Slot> slots_;
};

}  // namespace cluxel::sparql
