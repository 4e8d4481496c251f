// SPDX-License-Identifier: Apache-2.0
// Stable order of items by an integer key, in linear time: the sorted grids of the stages rest on it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace cluxel {

struct KeyedItem {
  std::uint64_t key = 0;
  std::uint32_t item = 0;
};

/// Sorts by key; equal keys keep their order. Digits in which all keys agree cost nothing.
inline void sortByKey(std::vector<KeyedItem>& items) {
  constexpr unsigned kDigitBits = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
  std::uint64_t varying = 0;
  for (const auto& entry : items) varying |= entry.key ^ items.front().key;
  std::vector<KeyedItem> other(items.size());
  for (unsigned shift = 0; shift < 64; shift += kDigitBits) {
    if (((varying >> shift) & (kBuckets - 1)) == 0) continue;
    std::array<std::size_t, kBuckets> start{};
    for (const auto& entry : items) ++start[(entry.key >> shift) & (kBuckets - 1)];
    std::size_t sum = 0;
    for (auto& value : start) sum += std::exchange(value, sum);
    for (const auto& entry : items) other[start[(entry.key >> shift) & (kBuckets - 1)]++] = entry;
    items.swap(other);
  }
}

}  // namespace cluxel
