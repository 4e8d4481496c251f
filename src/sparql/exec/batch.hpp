// SPDX-License-Identifier: Apache-2.0
// A batch of some hundred solutions, stored by column.
#pragma once

#include <cstddef>
#include <vector>

#include "sparql/algebra/algebra.hpp"

namespace cluxel::sparql {

struct Batch {
  std::size_t rows = 0;
  std::vector<std::vector<ValueId>> columns;  ///< by slot; empty if unbound in all rows

  explicit Batch(std::size_t slot_count = 0) : columns(slot_count) {}
  ValueId at(Slot slot, std::size_t row) const {
    const auto& column = columns[slot];
    return column.empty() ? kUnbound : column[row];
  }
  void reset() {
    rows = 0;
    for (auto& column : columns) column.clear();
  }
};

/// Appends the rows `picks` of `from` to `to`, for the given slots; missing columns become unbound.
inline void appendRows(const Batch& from, const std::vector<std::uint32_t>& picks, const std::vector<Slot>& slots,
                       std::size_t rows_before, Batch& to) {
  for (const Slot slot : slots) {
    const auto& source = from.columns[slot];
    auto& target = to.columns[slot];
    if (source.empty() && target.empty()) continue;
    target.resize(rows_before, kUnbound);
    target.resize(rows_before + picks.size(), kUnbound);
    if (source.empty()) continue;
    ValueId* out = target.data() + rows_before;
    for (const std::uint32_t pick : picks) *out++ = source[pick];
  }
}

/// Pads columns that were missing in the first rows, so that every non-empty column has `rows` entries.
inline void padColumns(Batch& batch, const std::vector<Slot>& slots) {
  for (const Slot slot : slots) {
    if (!batch.columns[slot].empty()) batch.columns[slot].resize(batch.rows, kUnbound);
  }
}

}  // namespace cluxel::sparql
