// SPDX-License-Identifier: Apache-2.0
// Compares the keys of an index with their sums before they are first read.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rdf/file/check/range_sums.hpp"
#include "rdf/file/page_directory.hpp"
#include "rdf/file/table.hpp"

namespace cluxel::rdf {

/// Checks one index of a commit. Also serves write transactions that began with this commit: their pages hold the same
/// keys, but for those that they added or removed. Thread-safe.
class PageGuard {
 public:
  /// `pages`: the directory of the commit, without a guard.
  PageGuard(const PageMap& map, PageDirectory pages, RangeSums ranges, Table index, std::filesystem::path file);

  /// Takes over the checks done for an earlier commit. Only valid when this process made all commits since.
  void inherit(const PageGuard& earlier);
  /// The pages of the commit without comparison, for estimates.
  const PageDirectory& pages() const { return pages_; }

  /// Compares the ranges that hold these keys of the commit. Throws Error (StoreUnavailable) when they differ from
  /// their sums, are out of order, or lie on a malformed page. Cost: 5 ns a key of the ranges, the first time.
  void check(Key128 first, Key128 last) const;
  void checkAll() const { check(0, ~Key128{0}); }
  /// Looks at the heads of the pages that LMDB may touch when it adds or removes these keys, which ascend: their pages,
  /// two before and behind, and the last page of the index. LMDB ends the program on malformed ones.
  void requireWellFormed(std::span<const Key128> keys) const;
  void requireAllWellFormed() const;

 private:
  void checkRange(std::size_t range) const;
  void requireWellFormed(std::size_t place) const;
  /// The greatest key that may lie on a page.
  Key128 lastOf(std::size_t place) const;
  [[noreturn]] void refuse(const std::string& what) const;

  PageMap map_;
  PageDirectory pages_;
  RangeSums ranges_;
  Table index_;
  std::filesystem::path file_;
  mutable std::vector<std::atomic<bool>> is_checked_;      ///< by range
  mutable std::vector<std::atomic<bool>> is_well_formed_;  ///< by page
};

}  // namespace cluxel::rdf
