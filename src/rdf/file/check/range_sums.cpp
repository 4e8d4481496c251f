// SPDX-License-Identifier: Apache-2.0
// Keeps the sums of ranges, which are stored as one block for each index.
#include "rdf/file/check/range_sums.hpp"

#include <algorithm>
#include <cstring>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/lmdb_environment.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::string_view kRangeTable = "index sums";

/// As a range is stored.
struct RangeRecord {
  std::uint64_t first_high = 0, first_low = 0, count = 0, hash = 0;
};

}  // namespace

std::size_t RangeSums::rangeOf(Key128 key) const {
  const auto after = std::upper_bound(ranges_.begin() + 1, ranges_.end(), key,
                                      [](Key128 wanted, const Range& range) { return wanted < range.first; });
  return static_cast<std::size_t>(after - ranges_.begin()) - 1;
}

std::size_t RangeSums::find(Key128 key) {
  if (found_ >= ranges_.size() || key < ranges_[found_].first || key > last(found_)) found_ = rangeOf(key);
  return found_;
}

Key128 RangeSums::last(std::size_t range) const {
  return range + 1 < ranges_.size() ? ranges_[range + 1].first - 1 : ~Key128{0};
}

EntrySum RangeSums::whole() const {
  EntrySum whole;
  for (const Range& range : ranges_) {
    whole.count += range.sum.count;
    whole.hash += range.sum.hash;
  }
  return whole;
}

bool RangeSums::hasLong() const {
  return std::any_of(ranges_.begin(), ranges_.end(), [](const Range& range) { return range.sum.count > kMaxKeys; });
}

void RangeSums::splitLong(const PageDirectory& directory, Table index, const std::filesystem::path& file) {
  std::vector<Range> divided;
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const Range& range = ranges_[i];
    if (range.sum.count <= kMaxKeys) {
      divided.push_back(range);
      continue;
    }
    RangeSummer summer(index);
    const Key128 end = last(i);
    for (PageDirectory::Position at = directory.lowerBound(range.first); at.page < directory.pageCount();
         at = {at.page + 1, 0}) {
      const std::span<const QuadKey> keys = directory.page(at.page).subspan(at.index);
      const auto stop =
          std::partition_point(keys.begin(), keys.end(), [end](const QuadKey& key) { return toNumber(key) <= end; });
      summer.add(keys.first(static_cast<std::size_t>(stop - keys.begin())));
      if (stop != keys.end()) break;
    }
    RangeSums parts = summer.take();
    if (parts.whole() != range.sum) refuseIndex(file, index, "differs from its checksum");
    parts.ranges_.front().first = range.first;
    divided.insert(divided.end(), parts.ranges_.begin(), parts.ranges_.end());
  }
  ranges_ = std::move(divided);
  found_ = 0;
}

void RangeSums::joinShort() {
  std::vector<Range> joined{ranges_.front()};
  for (std::size_t i = 1; i < ranges_.size(); ++i) {
    const EntrySum& sum = ranges_[i].sum;
    EntrySum& before = joined.back().sum;
    if (std::min(before.count, sum.count) >= kMinKeys || before.count + sum.count > kMaxKeys) {
      joined.push_back(ranges_[i]);
      continue;
    }
    before.count += sum.count;
    before.hash += sum.hash;
  }
  ranges_ = std::move(joined);
  found_ = 0;
}

std::string RangeSums::bytes() const {
  std::string bytes(ranges_.size() * sizeof(RangeRecord), '\0');
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const RangeRecord record{static_cast<std::uint64_t>(ranges_[i].first >> 64U),
                             static_cast<std::uint64_t>(ranges_[i].first), ranges_[i].sum.count, ranges_[i].sum.hash};
    std::memcpy(bytes.data() + i * sizeof record, &record, sizeof record);
  }
  return bytes;
}

RangeSums RangeSums::fromBytes(std::string_view bytes, const std::filesystem::path& file) {
  std::vector<Range> ranges(bytes.size() / sizeof(RangeRecord));
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    RangeRecord record;
    std::memcpy(&record, bytes.data() + i * sizeof record, sizeof record);
    ranges[i] = {(Key128{record.first_high} << 64U) | record.first_low, {record.count, record.hash}};
  }
  const auto not_ascending = [](const Range& a, const Range& b) { return a.first >= b.first; };
  if (ranges.empty() || bytes.size() % sizeof(RangeRecord) != 0 || ranges.front().first != 0 ||
      std::adjacent_find(ranges.begin(), ranges.end(), not_ascending) != ranges.end())
    refuseDamaged(file, "the sums of an index are malformed");
  return RangeSums(std::move(ranges));
}

void RangeSummer::add(std::span<const QuadKey> keys) {
  withKeysOfSum(index_, [&](const auto& key_in_sum) {
    for (const QuadKey& stored : keys) {
      const Key128 key = toNumber(stored);
      if (ranges_.back().sum.count == RangeSums::kUsualKeys) ranges_.push_back({key, {}});
      ranges_.back().sum.add(key_in_sum(key));
    }
  });
}

/// An index that never had a key has no block.
RangeSums storedRanges(ReadTransaction::Impl& transaction, Table index) {
  const auto bytes = readBlock(transaction, kRangeTable, kTableNames[static_cast<std::size_t>(index)]);
  return bytes ? RangeSums::fromBytes(*bytes, transaction.environment->file()) : RangeSums();
}

void storeRanges(WriteTransaction& transaction, Table index, const RangeSums& ranges) {
  transaction.putBlock(kRangeTable, kTableNames[static_cast<std::size_t>(index)], ranges.bytes());
}

}  // namespace cluxel::rdf
