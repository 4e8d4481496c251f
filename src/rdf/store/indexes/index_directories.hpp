// SPDX-License-Identifier: Apache-2.0
// The page directories of a write transaction. Making one looks at every page of an index; a small change alters few.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "rdf/file/page_directory.hpp"
#include "rdf/file/table.hpp"

namespace cluxel::rdf {

class PageGuard;
class StoreSnapshot;

/// A directory is that of the commit before until its index changes, and then follows the changes. Each call belongs to
/// the transaction that owns this.
class IndexDirectories {
 public:
  using Transaction = ReadTransaction::Impl;

  /// With the commit before the transaction. Without this call, directories are made anew after each change.
  void startFrom(std::shared_ptr<StoreSnapshot> committed);
  /// None without that call, and for maps whose pages are not read in place.
  const std::shared_ptr<StoreSnapshot>& committed() const { return committed_; }

  /// Of the index as the transaction sees it. Several threads may ask for different indexes.
  std::shared_ptr<const PageDirectory> of(Table index, Transaction& transaction);

  /// To be called before single keys are added or removed: looks at the pages that LMDB may touch.
  void requireWellFormed(Table index, Transaction& transaction, std::span<const Key128> added,
                         std::span<const Key128> removed);
  /// Of the index in its table, also where there is a draft.
  PageDirectory ofTable(Table index, Transaction& transaction);
  /// To be called after single keys were added or removed; both lists ascend.
  void noteKeys(Table index, Transaction& transaction, std::span<const Key128> added, std::span<const Key128> removed);
  /// To be called after an index was written anew, or moved to or from memory; `keys` in its table are new.
  void noteRewritten(Table index, std::uint64_t keys);
  /// Several threads may call it for different indexes.
  void noteDrafted(Table index);
  void noteBlock(std::size_t bytes) { other_pages_ += 8 + bytes / 2048; }
  /// To be called after LMDB has written its pages to the file and freed their memory.
  void notePagesWritten();
  void noteTerms(std::uint64_t count) { other_pages_ += 2 * count; }

 private:
  struct Entry {
    std::shared_ptr<const PageDirectory> directory;  ///< none: it has to be made
    bool is_committed = true;                        ///< the index is as it was before the transaction
    std::uint64_t dirty_pages = 0;                   ///< leaf pages that the transaction wrote
  };

  bool mayMovePages() const;
  std::shared_ptr<const PageGuard> guardOf(Table index, Transaction& transaction) const;

  std::shared_ptr<StoreSnapshot> committed_;
  std::array<Entry, kTableCount> entries_;
  std::uint64_t other_pages_ = 0;  ///< written at most, outside of indexes whose directories are known
};

}  // namespace cluxel::rdf
