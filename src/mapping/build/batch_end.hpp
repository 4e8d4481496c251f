// SPDX-License-Identifier: Apache-2.0
// When a batch of scans is committed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cluxel::mapping {

/// A full batch is committed, but takes along what is left when that is most likely less than half a batch: two commits
/// would decide twice about what lies between them.
inline bool endsBatch(std::uint64_t points, std::size_t scans, std::size_t scans_left, std::uint64_t batch_points) {
  if (points < batch_points || scans == 0) return false;
  const double left = static_cast<double>(scans_left) * static_cast<double>(points) / static_cast<double>(scans);
  return left > static_cast<double>(batch_points) / 2;
}

}  // namespace cluxel::mapping
