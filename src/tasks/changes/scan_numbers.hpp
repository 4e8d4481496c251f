// SPDX-License-Identifier: Apache-2.0
// Sets of scans by number.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>

namespace cluxel::tasks {

/// Scans are numbered by time, so that those which see one place mostly lie within 64 numbers. Such a set takes 24
/// bytes; scans beyond lie in a map.
class ScanNumbers {
 public:
  ScanNumbers() = default;
  /// Bit i is scan i.
  ScanNumbers(std::uint64_t first_scans) : word_(first_scans) {}
  ScanNumbers(const ScanNumbers& other) : word_(other.word_), number_(other.number_), others_(copyOf(other)) {}
  ScanNumbers(ScanNumbers&&) = default;
  ScanNumbers& operator=(const ScanNumbers& other) { return *this = ScanNumbers(other); }
  ScanNumbers& operator=(ScanNumbers&&) = default;
  ~ScanNumbers() = default;

  bool empty() const { return word_ == 0; }
  void insert(std::uint32_t scan) { add(scan / kBits, std::uint64_t{1} << scan % kBits); }
  bool contains(std::uint32_t scan) const { return (wordAt(scan / kBits) >> scan % kBits & 1U) != 0; }
  ScanNumbers& operator|=(const ScanNumbers& other) {
    other.forEachWord([this](std::uint32_t number, std::uint64_t word) { add(number, word); });
    return *this;
  }
  std::size_t size() const { return sizeWithout({}); }
  /// The smallest number; of a set that is not empty.
  std::uint32_t first() const {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
    forEachWord([&](std::uint32_t number, std::uint64_t word) {
      first = std::min(first, kBits * number + static_cast<std::uint32_t>(std::countr_zero(word)));
    });
    return first;
  }
  /// The largest number; of a set that is not empty.
  std::uint32_t last() const {
    std::uint32_t last = 0;
    forEachWord([&](std::uint32_t number, std::uint64_t word) {
      last = std::max(last, kBits * number + static_cast<std::uint32_t>(std::bit_width(word)) - 1);
    });
    return last;
  }
  /// How many scans are in this set and not in the other.
  std::size_t sizeWithout(const ScanNumbers& other) const {
    std::size_t size = 0;
    forEachWord([&](std::uint32_t number, std::uint64_t word) {
      size += static_cast<std::size_t>(std::popcount(word & ~other.wordAt(number)));
    });
    return size;
  }
  /// Visits the scans, in no certain order.
  template <typename Visit>
  void forEach(const Visit& visit) const {
    forEachWord([&](std::uint32_t number, std::uint64_t word) {
      for (; word != 0; word &= word - 1) visit(kBits * number + static_cast<std::uint32_t>(std::countr_zero(word)));
    });
  }

 private:
  using Words = std::map<std::uint32_t, std::uint64_t>;
  static constexpr std::uint32_t kBits = 64;

  static std::unique_ptr<Words> copyOf(const ScanNumbers& set) {
    return set.others_ ? std::make_unique<Words>(*set.others_) : nullptr;
  }

  std::uint64_t wordAt(std::uint32_t number) const {
    if (number == number_) return word_;
    if (!others_) return 0;
    const auto other = others_->find(number);
    return other == others_->end() ? 0 : other->second;
  }

  void add(std::uint32_t number, std::uint64_t word) {
    if (word_ == 0) number_ = number;
    if (number == number_) {
      word_ |= word;
      return;
    }
    if (!others_) others_ = std::make_unique<Words>();
    (*others_)[number] |= word;
  }

  template <typename Visit>
  void forEachWord(const Visit& visit) const {
    if (word_ != 0) visit(number_, word_);
    if (others_)
      for (const auto& [number, word] : *others_) visit(number, word);
  }

  std::uint64_t word_ = 0;    ///< the scans from 64 `number_` on
  std::uint32_t number_ = 0;  ///< of the first scan that was added, over 64
  std::unique_ptr<Words> others_;
};

}  // namespace cluxel::tasks
