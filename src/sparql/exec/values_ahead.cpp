// SPDX-License-Identifier: Apache-2.0
// Prefetches the values of the slots that expressions use.
#include "sparql/exec/values_ahead.hpp"

#include <algorithm>

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

bool isText(const Expr& expression) {
  return expression.kind == Kind::Constant && expression.constant.isStringLike();
}

void addOnce(std::vector<Slot>& slots, Slot slot) {
  if (std::find(slots.begin(), slots.end(), slot) == slots.end()) slots.push_back(slot);
}

}  // namespace

/// Numbers need the decoded value only; functions and text comparisons read the term as well.
void ValuesAhead::collect(const Expr& expression, bool as_text) {
  if (expression.kind == Kind::Slot) {
    addOnce(values_, expression.slot);
    if (as_text) addOnce(texts_, expression.slot);
    return;
  }
  if (expression.kind == Kind::Bound) return;
  const auto& arguments = expression.arguments;
  const bool text = as_text || expression.kind == Kind::Call || std::any_of(arguments.begin(), arguments.end(), isText);
  for (const Expr& argument : arguments) collect(argument, text);
}

void ValuesAhead::expect(std::size_t row, const Batch& batch, const QueryTerms& terms) const {
  const std::size_t count = std::min(kTogether, batch.rows - row);
  for (const Slot slot : values_) {
    const auto& column = batch.columns[slot];
    if (column.size() >= row + count) terms.expectValues({column.data() + row, count});
  }
  for (const Slot slot : texts_) {
    const auto& column = batch.columns[slot];
    if (column.size() >= row + count) terms.expect({column.data() + row, count});
  }
}

}  // namespace cluxel::sparql
