// SPDX-License-Identifier: Apache-2.0
// The steps to which local coordinates are rounded.
#pragma once

#include "perception/clustering/fast_floor.hpp"

namespace cluxel::perception {

/// Local x and y are rounded to this step [m]: then they and their shifts to a neighbouring tile are exact floats, and
/// a difference is the same number in either tile's frame.
inline constexpr double kLocalStep_m = 1.0 / 262144.0;
/// Heights are rounded to this step [m], a quarter of a millimetre: they are exact floats up to 4 km above and below
/// the origin of the grid. So neither they nor their differences depend on where that origin is.
inline constexpr double kHeightStep_m = 1.0 / 4096.0;

/// Rounded down, so that shifts to a neighbouring tile stay exact.
inline float toLocalStep(double value_m) {
  return static_cast<float>(static_cast<double>(fastFloor(value_m / kLocalStep_m)) * kLocalStep_m);
}
/// Rounded to the nearest step.
inline float toHeightStep(double value_m) {
  return static_cast<float>(static_cast<double>(fastFloor(value_m / kHeightStep_m + 0.5)) * kHeightStep_m);
}

}  // namespace cluxel::perception
