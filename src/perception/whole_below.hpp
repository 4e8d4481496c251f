// SPDX-License-Identifier: Apache-2.0
// std::floor where it is asked for every point: without SSE4.1 that is a call of the library.
#pragma once

#include <cstdint>

namespace cluxel {

/// The largest whole number that is not above `value`, which must lie within +-2^62.
inline std::int64_t wholeBelow(double value) {
  const auto toward_zero = static_cast<std::int64_t>(value);
  return toward_zero - (static_cast<double>(toward_zero) > value ? 1 : 0);
}

}  // namespace cluxel
