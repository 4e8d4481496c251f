// SPDX-License-Identifier: Apache-2.0
// Stable order of items by an integer key, in linear time: the sorted grids of the stages rest on it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace cluxel {

struct KeyedItem {
  std::uint64_t key = 0;
  std::uint32_t item = 0;
};

/// The bits in which keys differ, moved together: few passes then suffice, and the order stays the same.
class KeyBits {
 public:
  explicit KeyBits(const std::vector<KeyedItem>& items) {
    std::uint64_t varying = 0;
    for (const auto& entry : items) varying |= entry.key ^ items.front().key;
    while (varying != 0) {
      const int first = std::countr_zero(varying), length = std::countr_one(varying >> first);
      const std::uint64_t mask = length == 64 ? ~std::uint64_t{0} : ((std::uint64_t{1} << length) - 1) << first;
      runs_[run_count_++] = {mask, first - bits_};
      bits_ += length;
      varying &= ~mask;
    }
  }
  int bits() const { return bits_; }
  std::uint64_t operator()(std::uint64_t key) const {
    std::uint64_t packed = 0;
    for (std::size_t i = 0; i < run_count_; ++i) packed |= (key & runs_[i].mask) >> runs_[i].shift;
    return packed;
  }

 private:
  struct Run {
    std::uint64_t mask;
    int shift;
  };
  std::array<Run, 33> runs_{};
  std::size_t run_count_ = 0;
  int bits_ = 0;
};

/// Sorts by packed keys of any length; equal keys keep their order.
inline void sortByLongKey(std::vector<KeyedItem>& items, const KeyBits& packed) {
  constexpr int kDigitBits = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
  std::vector<KeyedItem> other(items.size());
  for (int shift = 0; shift < packed.bits(); shift += kDigitBits) {
    const auto digit = [&](const KeyedItem& entry) { return (packed(entry.key) >> shift) & (kBuckets - 1); };
    std::array<std::uint32_t, kBuckets> start{};
    for (const auto& entry : items) ++start[digit(entry)];
    std::uint32_t sum = 0;
    for (auto& value : start) sum += std::exchange(value, sum);
    for (const auto& entry : items) other[start[digit(entry)]++] = entry;
    items.swap(other);
  }
}

/// The same where a packed key and a place fit into one number, as they do in a tile: half as much is moved about. What
/// each digit counts is counted in one run.
inline void sortByShortKey(std::vector<KeyedItem>& items, const KeyBits& packed) {
  constexpr int kMostDigitBits = 11, kMostPasses = 3;
  constexpr std::size_t kMostBuckets = std::size_t{1} << kMostDigitBits;
  const int passes = (packed.bits() + kMostDigitBits - 1) / kMostDigitBits, digit_bits = (packed.bits() + passes - 1) / passes;
  const std::size_t buckets = std::size_t{1} << digit_bits;
  const auto digit = [&](std::uint64_t entry, int pass) { return (entry >> (32 + pass * digit_bits)) & (buckets - 1); };
  std::array<std::array<std::uint32_t, kMostBuckets>, kMostPasses> start;
  for (int pass = 0; pass < passes; ++pass) std::fill_n(start[static_cast<std::size_t>(pass)].begin(), buckets, 0U);
  std::vector<std::uint64_t> order(items.size()), other(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    order[i] = packed(items[i].key) << 32U | i;
    for (int pass = 0; pass < passes; ++pass) ++start[static_cast<std::size_t>(pass)][digit(order[i], pass)];
  }
  for (int pass = 0; pass < passes; ++pass) {
    auto& place = start[static_cast<std::size_t>(pass)];
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) sum += std::exchange(place[b], sum);
    for (const auto entry : order) other[place[digit(entry, pass)]++] = entry;
    order.swap(other);
  }
  std::vector<KeyedItem> sorted(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) sorted[i] = items[order[i] & 0xffffffffU];
  items.swap(sorted);
}

/// Sorts by key; equal keys keep their order.
inline void sortByKey(std::vector<KeyedItem>& items) {
  const KeyBits packed(items);
  if (packed.bits() == 0) return;
  if (packed.bits() <= 32)
    sortByShortKey(items, packed);
  else
    sortByLongKey(items, packed);
}

}  // namespace cluxel
