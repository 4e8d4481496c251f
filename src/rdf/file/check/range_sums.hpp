// SPDX-License-Identifier: Apache-2.0
// The sums of an index by ranges of its keys: who reads a part of an index compares that part only.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rdf/file/check/store_sums.hpp"
#include "rdf/file/page_directory.hpp"
#include "rdf/file/table.hpp"

namespace cluxel::rdf {

/// Ranges of some 16 thousand keys, which cover all possible keys without gaps.
class RangeSums {
 public:
  struct Range {
    Key128 first = 0;  ///< the least key that belongs to the range
    EntrySum sum;      ///< of the keys, in the order of sums (keyInSum())
  };
  static constexpr std::uint64_t kUsualKeys = 16384, kMaxKeys = 2 * kUsualKeys, kMinKeys = kUsualKeys / 4;

  RangeSums() : ranges_(1) {}
  explicit RangeSums(std::vector<Range> ranges) : ranges_(std::move(ranges)) {}

  std::span<const Range> ranges() const { return ranges_; }
  std::size_t rangeOf(Key128 key) const;
  /// The greatest key that belongs to a range.
  Key128 last(std::size_t range) const;
  EntrySum whole() const;

  /// To be called when a key of the index was added or removed. Ascending keys are faster than others.
  void add(Key128 key, Key128 in_sum) { ranges_[find(key)].sum.add(in_sum); }
  void remove(Key128 key, Key128 in_sum) { ranges_[find(key)].sum.remove(in_sum); }
  /// Whether some range has more than `kMaxKeys`.
  bool hasLong() const;
  /// Splits these. Throws Error (StoreUnavailable) when the index holds other keys than these sums state. Cost: reads
  /// the keys of ranges that are split.
  void splitLong(const PageDirectory& directory, Table index, const std::filesystem::path& file);
  /// Joins ranges of less than `kMinKeys` to the one before or behind, when both have at most `kMaxKeys` together.
  void joinShort();

  std::string bytes() const;
  /// Throws Error (StoreUnavailable) when the bytes are malformed.
  static RangeSums fromBytes(std::string_view bytes, const std::filesystem::path& file);

 private:
  std::size_t find(Key128 key);

  std::vector<Range> ranges_;  ///< ascending; the first begins with key 0
  std::size_t found_ = 0;      ///< by the last find()
};

/// Makes the sums of an index from its keys in ascending order.
class RangeSummer {
 public:
  explicit RangeSummer(Table index) : index_(index) {}
  void add(std::span<const QuadKey> keys);
  RangeSums take() { return RangeSums(std::move(ranges_)); }

 private:
  Table index_;
  std::vector<RangeSums::Range> ranges_{1};
};

/// The sums of the commit, or the state of a write transaction, that `transaction` sees.
RangeSums storedRanges(ReadTransaction::Impl& transaction, Table index);
void storeRanges(WriteTransaction& transaction, Table index, const RangeSums& ranges);

}  // namespace cluxel::rdf
