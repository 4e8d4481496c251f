// SPDX-License-Identifier: Apache-2.0
// Angles that are the same on every processor.
#pragma once

#include <algorithm>
#include <cmath>

namespace cluxel {

/// The C library's trigonometric functions differ in the last bit of a double between processors with and without fused
/// multiply-add. To a float's precision they agree, but for one value in some 10^8.
inline double steady(double value) {
  return static_cast<float>(value);
}

/// The angle whose cosine has this size, in [0, pi/2] [rad].
inline double steadyAcos(double cosine) {
  return steady(std::acos(std::clamp(std::abs(cosine), 0.0, 1.0)));
}

}  // namespace cluxel
