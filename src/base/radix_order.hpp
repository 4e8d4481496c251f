// SPDX-License-Identifier: Apache-2.0
// Stable radix sort by an integer key, in linear time: the basis of the sorted grids.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace cluxel {

struct KeyedItem {
  std::uint64_t key = 0;
  std::uint32_t item = 0;
};

/// Compacts keys to the bits in which they differ: fewer passes, same order.
class KeyBits {
 public:
  /// Of `count` keys; `key(i)` is the i-th.
  template <typename KeyAt>
  KeyBits(std::size_t count, const KeyAt& key) {
    std::uint64_t varying = 0;
    for (std::size_t i = 1; i < count; ++i) varying |= key(i) ^ key(0);
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

/// Stable sorted indices of the keys, for keys whose compacted bits and index fit into one 64-bit number, as they do in
/// a tile: this moves the least memory. The histograms of all digits are counted in one pass.
template <typename KeyAt>
std::vector<std::uint32_t> orderByShortKey(std::size_t count, const KeyAt& key, const KeyBits& packed) {
  constexpr int kMaxDigitBits = 11, kMaxPasses = 3;
  constexpr std::size_t kMaxBuckets = std::size_t{1} << kMaxDigitBits;
  const int passes = (packed.bits() + kMaxDigitBits - 1) / kMaxDigitBits,
            digit_bits = (packed.bits() + passes - 1) / passes;
  const std::size_t buckets = std::size_t{1} << digit_bits;
  const auto digit = [&](std::uint64_t entry, int pass) { return (entry >> (32 + pass * digit_bits)) & (buckets - 1); };
  std::array<std::array<std::uint32_t, kMaxBuckets>, kMaxPasses> start;
  for (int pass = 0; pass < passes; ++pass) std::fill_n(start[static_cast<std::size_t>(pass)].begin(), buckets, 0U);
  std::vector<std::uint64_t> entries(count), other(passes > 1 ? count : 0);
  for (std::size_t i = 0; i < count; ++i) {
    entries[i] = packed(key(i)) << 32U | i;
    for (int pass = 0; pass < passes; ++pass) ++start[static_cast<std::size_t>(pass)][digit(entries[i], pass)];
  }
  std::vector<std::uint32_t> order(count);
  for (int pass = 0; pass < passes; ++pass) {
    auto& place = start[static_cast<std::size_t>(pass)];
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) sum += std::exchange(place[b], sum);
    if (pass + 1 < passes) {
      for (const auto entry : entries) other[place[digit(entry, pass)]++] = entry;
      entries.swap(other);
    } else {
      for (const auto entry : entries) order[place[digit(entry, pass)]++] = static_cast<std::uint32_t>(entry);
    }
  }
  return order;
}

/// Sorts by key; equal keys keep their order.
inline void sortByKey(std::vector<KeyedItem>& items) {
  const auto key = [&](std::size_t i) { return items[i].key; };
  const KeyBits packed(items.size(), key);
  if (packed.bits() == 0) return;
  if (packed.bits() > 32) return sortByLongKey(items, packed);
  const auto order = orderByShortKey(items.size(), key, packed);
  std::vector<KeyedItem> sorted(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) sorted[i] = items[order[i]];
  items.swap(sorted);
}

/// The indices of the keys in ascending order; equal keys keep their order.
inline std::vector<std::uint32_t> orderOf(const std::vector<std::uint64_t>& keys) {
  const auto key = [&](std::size_t i) { return keys[i]; };
  const KeyBits packed(keys.size(), key);
  std::vector<std::uint32_t> order(keys.size());
  if (packed.bits() > 32) {
    std::vector<KeyedItem> items(keys.size());
    for (std::uint32_t i = 0; i < keys.size(); ++i) items[i] = {keys[i], i};
    sortByLongKey(items, packed);
    for (std::size_t i = 0; i < keys.size(); ++i) order[i] = items[i].item;
  } else if (packed.bits() > 0) {
    order = orderByShortKey(keys.size(), key, packed);
  } else {
    std::iota(order.begin(), order.end(), 0U);
  }
  return order;
}

/// Sorts numbers. Those of a small range, such as positions, in linear time.
template <std::unsigned_integral Number>
void sortNumbers(std::vector<Number>& numbers) {
  constexpr std::size_t kFew = 128;  // these are sorted faster by comparisons
  if (std::is_sorted(numbers.begin(), numbers.end())) return;
  if (numbers.size() < kFew) return std::sort(numbers.begin(), numbers.end());
  const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
  const Number lowest = *low, range = *high - *low;
  std::vector<Number> other(numbers.size());
  for (int shift = 0; shift < static_cast<int>(std::bit_width(range)); shift += 8) {
    const auto digit = [&](Number number) { return ((number - lowest) >> shift) & 0xFFU; };
    std::array<std::size_t, 256> start{};
    for (const Number number : numbers) ++start[digit(number)];
    std::size_t sum = 0;
    for (auto& value : start) sum += std::exchange(value, sum);
    for (const Number number : numbers) other[start[digit(number)]++] = number;
    numbers.swap(other);
  }
}

}  // namespace cluxel
