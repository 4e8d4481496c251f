// SPDX-License-Identifier: Apache-2.0
// Asks the store for the values that expressions will look at, some rows before they are computed: at once they cost
// little more than one of them.
#pragma once

#include <vector>

#include "sparql/runtime.hpp"

namespace cluxel::sparql {

class ValuesAhead {
 public:
  /// The slots whose values, or texts, the expression looks at.
  void add(const Expr& expression) { collect(expression, false); }
  /// The texts as well, whatever the expression is.
  void addTexts(const Expr& expression) { collect(expression, true); }

  /// To be called before each row of a batch in turn.
  void before(std::size_t row, const Batch& batch, const QueryTerms& terms) {
    if (row % kTogether == 0 && batch.rows - row >= kFewRows) expect(row, batch, terms);
  }

 private:
  static constexpr std::size_t kTogether = 64, kFewRows = 4;
  void collect(const Expr& expression, bool as_text);
  void expect(std::size_t row, const Batch& batch, const QueryTerms& terms) const;

  std::vector<Slot> values_, texts_;
};

}  // namespace cluxel::sparql
