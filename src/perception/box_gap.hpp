// SPDX-License-Identifier: Apache-2.0
// The gap between two boxes, where it is asked for millions of pairs.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace cluxel {

/// The distance of two boxes [m], 0 when they meet.
inline float gapBetween(const Eigen::Vector3f& min_a, const Eigen::Vector3f& max_a, const Eigen::Vector3f& min_b,
                        const Eigen::Vector3f& max_b) {
  const auto along = [&](int i) { return std::max(std::max(min_a[i] - max_b[i], min_b[i] - max_a[i]), 0.0F); };
  const float x = along(0), y = along(1), z = along(2);
  return std::sqrt(x * x + (y * y + z * z));
}

}  // namespace cluxel
