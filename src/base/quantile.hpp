// SPDX-License-Identifier: Apache-2.0
// Quantiles of samples.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace cluxel {

/// The value below which a share in [0, 1] of the values lies, interpolated linearly between neighbours. `ascending`
/// must not be empty.
inline double quantileOf(std::span<const double> ascending, double share) {
  const double place = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  return ascending[below] + (place - static_cast<double>(below)) * (ascending[above] - ascending[below]);
}

}  // namespace cluxel
