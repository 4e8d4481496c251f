// SPDX-License-Identifier: Apache-2.0
// The first keys of all leaf pages of an index: one binary search replaces the descent through the B-tree.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/lmdb_page.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// A key as a number, which compares in two machine instructions.
__extension__ using Key128 = unsigned __int128;

inline Key128 toNumber(const QuadKey& key) {
  std::uint64_t high = 0;
  std::uint64_t low = 0;
  std::memcpy(&high, key.bytes.data(), 8);
  std::memcpy(&low, key.bytes.data() + 8, 8);
  return (static_cast<Key128>(__builtin_bswap64(high)) << 64U) | __builtin_bswap64(low);
}

inline QuadKey toKey(Key128 number) {
  QuadKey key;
  const std::uint64_t high = __builtin_bswap64(static_cast<std::uint64_t>(number >> 64U));
  const std::uint64_t low = __builtin_bswap64(static_cast<std::uint64_t>(number));
  std::memcpy(key.bytes.data(), &high, 8);
  std::memcpy(key.bytes.data() + 8, &low, 8);
  return key;
}

/// The error for a part of the map (for example "an index") that points outside the file.
[[noreturn]] void failOutside(const char* part);

/// Every index stores its entries as MDB_DUPFIXED duplicates of this key.
inline constexpr std::string_view kIndexKey = "q";

/// The mapped file of a snapshot: pages by number.
struct PageMap {
  const std::uint8_t* base = nullptr;
  std::uint64_t page_size = 0, page_count = 0;

  /// Throws when a damaged file points outside itself.
  const std::uint8_t* page(lmdb_page::PageNumber number) const;
};

/// The number of leaf pages of an index of a mapped commit, as its root states it; `table` is its root record. 0 for an
/// index that lies within its root's page.
std::uint64_t leafPagesOf(const PageMap& map, const lmdb_page::Tree& table);

class PageGuard;

/// The leaf pages of one index in key order, at one commit or one state of a write transaction. With a guard, a page is
/// compared with its sums when it is first read, and what reads it throws Error (StoreUnavailable) when it differs.
class PageDirectory {
 public:
  struct Position {
    std::size_t page = 0, index = 0;
  };

  PageDirectory() = default;
  /// Built from the branch pages of a mapped commit; `table` is the root record of the index. Cost: one step per leaf
  /// page, without reading leaf pages.
  PageDirectory(const PageMap& map, const lmdb_page::Tree& table);
  /// Built with an LMDB cursor, which also sees the dirty pages of a write transaction. Cost: reads the first key of
  /// each leaf page.
  explicit PageDirectory(MDB_cursor* cursor);
  /// Of pages in memory: where their keys begin, and their first keys, ascending; none is empty. The pages must live as
  /// long.
  PageDirectory(std::vector<const QuadKey*> pages, std::vector<Key128> first_keys);
  /// The same pages, guarded.
  PageDirectory(const PageDirectory& pages, std::shared_ptr<const PageGuard> guard);

  void guardBy(std::shared_ptr<const PageGuard> guard);
  /// None where pages need not be compared.
  const std::shared_ptr<const PageGuard>& guard() const { return guard_; }

  std::size_t pageCount() const { return pages_.size(); }
  std::span<const QuadKey> page(std::size_t i) const {
    if (is_checked_ && !is_checked_[i].load(std::memory_order_relaxed)) check(i);
    return uncheckedPage(i);
  }
  std::span<const QuadKey> uncheckedPage(std::size_t i) const {
    const QuadKey* keys = pages_[i];
    return {keys, single_ ? 1 : entryCount(keys)};
  }
  /// Where the keys of the pages begin, and the lower bounds of the pages.
  std::span<const QuadKey* const> pages() const { return pages_; }
  std::span<const Key128> lowers() const { return lower_; }
  /// No key of page `i` is less, and all keys of earlier pages are.
  Key128 lower(std::size_t i) const { return lower_[i]; }
  Position begin() const { return {}; }
  Position end() const { return {pages_.size(), 0}; }
  /// The last page whose lower bound is not greater than `key`, or 0. Expects a page.
  std::size_t pageOf(Key128 key) const;
  /// The first key not less than `key`.
  Position lowerBound(Key128 key) const;
  /// As above; fast when the result is on the page of `hint` or the next.
  Position lowerBound(Key128 key, Position hint) const;
  /// Batched lower bounds: all searches advance in lockstep, so that their cache misses overlap.
  void lowerBounds(std::span<const Key128> keys, std::span<Position> found) const;
  /// The exact number of keys in [from, to). Cost: one step per page.
  std::uint64_t distance(Position from, Position to) const;

 private:
  std::size_t entryCount(const QuadKey* keys) const {
    const auto* page = reinterpret_cast<const std::uint8_t*>(keys) - lmdb_page::kHeaderSize;
    return std::min<std::size_t>(lmdb_page::entryCount(page), max_keys_);
  }
  void check(std::size_t page) const;
  void addPage(Key128 lower, const std::uint8_t* page);
  void collect(const PageMap& map, lmdb_page::PageNumber number, Key128 lower, int depth);
  Position within(std::size_t page, Key128 key) const;
  void lowerBoundsOfGroup(std::span<const Key128> keys, std::span<Position> found) const;
  void searchPages(std::span<const Key128> keys, std::span<Position> found) const;

  static constexpr std::size_t kTogether = 64;
  std::size_t max_keys_ = 65536 / sizeof(QuadKey);  ///< per page; bounds the entry count that a damaged page states
  std::vector<Key128> lower_;                       ///< the first key of each page
  std::vector<const QuadKey*> pages_;
  std::shared_ptr<const PageGuard> guard_;
  std::unique_ptr<std::atomic<bool>[]> is_checked_;  ///< by page; none without a guard
  bool single_ = false;                              ///< a single key is stored in the node itself, without a sub-page
};

}  // namespace cluxel::rdf
