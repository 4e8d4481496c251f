// SPDX-License-Identifier: Apache-2.0
// std::floor for inner loops: without SSE4.1, std::floor is a library call.
#pragma once

#include <cstdint>

namespace cluxel::perception {

/// The largest integer not above `value`, which must lie within +-2^62.
inline std::int64_t fastFloor(double value) {
  const auto toward_zero = static_cast<std::int64_t>(value);
  return toward_zero - (static_cast<double>(toward_zero) > value ? 1 : 0);
}

}  // namespace cluxel::perception
