// SPDX-License-Identifier: Apache-2.0
// When a batch of scans is committed, and how much of a change goes through the stages at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace cluxel::mapping {

/// Points of a batch of scans when nothing else is asked for. With a rest of half as many it takes up to 2 GiB of
/// memory where places are new (generated city, two threads): decision 0126.
inline constexpr std::uint64_t kBatchPoints = 70'000'000;

/// Whether a batch, or a part of one, of `scans` scans is to be closed. A full one takes along what is left when that
/// is most likely less than half of `max_points`: two of them would compute twice what lies between them.
inline bool isFull(std::uint64_t points, std::size_t scans, std::size_t scans_left, std::uint64_t max_points) {
  if (points < max_points || scans == 0) return false;
  const double left = static_cast<double>(scans_left) * static_cast<double>(points) / static_cast<double>(scans);
  return left > static_cast<double>(max_points) / 2;
}

/// How many points go into one part of a change that reaches `points` of the `map_points` of a map. Up to one and a
/// half times `max_points` are one part. Else a part has at most a quarter of the map: a larger one would be computed
/// over the whole map, not around the part.
inline std::uint64_t partSize(std::uint64_t points, std::uint64_t map_points, std::uint64_t max_points) {
  if (static_cast<double>(points) < 1.5 * static_cast<double>(max_points)) return points;
  return std::max<std::uint64_t>(1, std::min(max_points, map_points / 4));
}

}  // namespace cluxel::mapping
