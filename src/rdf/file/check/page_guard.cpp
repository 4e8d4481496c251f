// SPDX-License-Identifier: Apache-2.0
// A range is compared as a whole, with the pages of the commit, which stay as they are while others are written.
#include "rdf/file/check/page_guard.hpp"

#include <algorithm>

#include "rdf/file/check/map_file_head.hpp"

namespace cluxel::rdf {

using namespace lmdb_page;

PageGuard::PageGuard(const PageMap& map, PageDirectory pages, RangeSums ranges, Table index, std::filesystem::path file)
    : map_(map),
      pages_(std::move(pages)),
      ranges_(std::move(ranges)),
      index_(index),
      file_(std::move(file)),
      is_checked_(ranges_.ranges().size()),
      is_well_formed_(pages_.pageCount()) {}

void PageGuard::inherit(const PageGuard& earlier) {
  for (std::size_t range = 0; range < is_checked_.size(); ++range) {
    std::size_t before = earlier.ranges_.rangeOf(ranges_.ranges()[range].first);
    const std::size_t end = earlier.ranges_.rangeOf(ranges_.last(range)) + 1;
    while (before < end && earlier.is_checked_[before].load(std::memory_order_relaxed)) ++before;
    is_checked_[range].store(before == end, std::memory_order_relaxed);
  }
}

void PageGuard::refuse(const std::string& what) const {
  refuseIndex(file_, index_, what);
}

Key128 PageGuard::lastOf(std::size_t place) const {
  return place + 1 < pages_.pageCount() ? pages_.lower(place + 1) - 1 : ~Key128{0};
}

void PageGuard::check(Key128 first, Key128 last) const {
  if (last < first) refuse("has keys out of order");
  for (std::size_t range = ranges_.rangeOf(first), end = ranges_.rangeOf(last); range <= end; ++range)
    if (!is_checked_[range].load(std::memory_order_relaxed)) checkRange(range);
}

void PageGuard::requireWellFormed(std::span<const Key128> keys) const {
  constexpr std::size_t kBeside = 2;
  const std::size_t count = pages_.pageCount();
  std::size_t place = 0, next = 0;  // pages before `next` are done with
  for (const Key128 key : keys) {
    while (place + 1 < count && pages_.lower(place + 1) <= key) ++place;
    next = std::max(next, place - std::min(place, kBeside));
    for (; next < std::min(count, place + kBeside + 1); ++next) requireWellFormed(next);
  }
  check(pages_.lower(count - 1), ~Key128{0});  // whether keys are appended depends on the last one
}

void PageGuard::requireAllWellFormed() const {
  for (std::size_t place = 0; place < pages_.pageCount(); ++place) requireWellFormed(place);
}

void PageGuard::requireWellFormed(std::size_t place) const {
  if (is_well_formed_[place].load(std::memory_order_relaxed)) return;
  const auto* page = reinterpret_cast<const std::uint8_t*>(pages_.page(place).data()) - kHeaderSize;
  if (header(page).number != static_cast<PageNumber>(page - map_.base) / map_.page_size ||
      header(page).flags != (kLeaf | kFixedKeys) || !isPageOfKeys(page, map_.page_size, sizeof(QuadKey)))
    refuse("has a malformed page");
  is_well_formed_[place].store(true, std::memory_order_relaxed);
}

void PageGuard::checkRange(std::size_t range) const {
  const Key128 first = ranges_.ranges()[range].first, last = ranges_.last(range);
  EntrySum sum;
  for (std::size_t place = pages_.pageOf(first), end = pages_.pageOf(last) + 1; place < end; ++place) {
    requireWellFormed(place);
    const std::span<const QuadKey> keys = pages_.page(place);
    bool in_order = toNumber(keys.front()) >= pages_.lower(place) && toNumber(keys.back()) <= lastOf(place);
    Key128 before = toNumber(keys.front()) - 1;
    withKeysOfSum(index_, [&](const auto& key_in_sum) {
      for (const QuadKey& stored : keys) {
        const Key128 key = toNumber(stored);
        in_order = in_order && key > before;
        before = key;
        if (key >= first && key <= last) sum.add(key_in_sum(key));
      }
    });
    if (!in_order) refuse("has keys out of order");
  }
  if (sum != ranges_.ranges()[range].sum) refuse("differs from its checksum");
  is_checked_[range].store(true, std::memory_order_relaxed);
}

}  // namespace cluxel::rdf
