// SPDX-License-Identifier: Apache-2.0
// Prefetches the values of the slots that expressions use.
#include "sparql/exec/values_ahead.hpp"

#include <algorithm>

namespace cluxel::sparql {

void ValuesAhead::add(const Expr& expression) {
  if (expression.kind == Expr::Kind::Bound) return;
  if (expression.kind == Expr::Kind::Slot) {
    if (std::find(slots_.begin(), slots_.end(), expression.slot) == slots_.end()) slots_.push_back(expression.slot);
    return;
  }
  for (const Expr& argument : expression.arguments) add(argument);
}

void ValuesAhead::expect(std::size_t row, const Batch& batch, const QueryTerms& terms) const {
  const std::size_t count = std::min(kTogether, batch.rows - row);
  for (const Slot slot : slots_) {
    const auto& column = batch.columns[slot];
    if (column.size() >= row + count) terms.expectValues({column.data() + row, count});
  }
}

}  // namespace cluxel::sparql
