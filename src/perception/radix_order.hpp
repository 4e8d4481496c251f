// SPDX-License-Identifier: Apache-2.0
// Stable order of items by an integer key, in linear time: the sorted grids of the stages rest on it.
#pragma once

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

/// Sorts by key; equal keys keep their order.
inline void sortByKey(std::vector<KeyedItem>& items) {
  constexpr int kDigitBits = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
  const KeyBits packed(items);
  std::vector<KeyedItem> other(packed.bits() > 0 ? items.size() : 0);
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

}  // namespace cluxel
