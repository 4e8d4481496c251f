// SPDX-License-Identifier: Apache-2.0
// Transposition of four rows at a time.
#pragma once

#include <algorithm>
#include <array>

#include "perception/simd_vector.hpp"

namespace cluxel::perception {

/// The transposed 4 x 4 matrix.
inline std::array<Floats, kLanes> transposed(const std::array<Floats, kLanes>& rows) {
  const auto& [a, b, c, d] = rows;
  const Floats ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Floats ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7), cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {__builtin_shufflevector(ab, cd, 0, 1, 4, 5), __builtin_shufflevector(ab, cd, 2, 3, 6, 7),
          __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5), __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7)};
}

/// Writes value c of row r to to[c * stride + r], for four rows of `count` values.
inline void transposeRows(const std::array<const float*, kLanes>& rows, std::size_t count, float* to,
                          std::size_t stride) {
  if (count < kLanes) {
    for (std::size_t c = 0; c < count; ++c)
      for (std::size_t r = 0; r < kLanes; ++r) to[c * stride + r] = rows[r][c];
    return;
  }
  for (std::size_t next = 0; next < count; next += kLanes) {
    const std::size_t c = std::min(next, count - kLanes);  // the last block may overlap the one before
    const auto columns = transposed(
        {loadFloats(rows[0] + c), loadFloats(rows[1] + c), loadFloats(rows[2] + c), loadFloats(rows[3] + c)});
    for (std::size_t k = 0; k < kLanes; ++k) storeFloats(columns[k], to + (c + k) * stride);
  }
}

}  // namespace cluxel::perception
