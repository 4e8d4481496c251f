// SPDX-License-Identifier: Apache-2.0
// When a batch of scans is committed, and when a part of it goes through the stages.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cluxel::mapping {

/// Whether a batch, or a part of one, of `scans` scans is to be closed. A full one takes along what is left when that
/// is most likely less than half of `max_points`: two of them would compute twice what lies between them.
inline bool isFull(std::uint64_t points, std::size_t scans, std::size_t scans_left, std::uint64_t max_points) {
  if (points < max_points || scans == 0) return false;
  const double left = static_cast<double>(scans_left) * static_cast<double>(points) / static_cast<double>(scans);
  return left > static_cast<double>(max_points) / 2;
}

}  // namespace cluxel::mapping
