// SPDX-License-Identifier: Apache-2.0
// An index beside its table: what a transaction that changes most of an index reads and changes until it commits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "rdf/file/page_directory.hpp"
#include "rdf/store/indexes/draft_pages.hpp"

namespace cluxel::rdf {

/// Sorted keys in pages that are laid out as LMDB's, so that page directories read them as they read the file.
class IndexDraft {
 public:
  /// A large draft makes a file in `folder` (DraftPages).
  explicit IndexDraft(std::filesystem::path folder) : memory_(std::move(folder)) {}
  IndexDraft(const IndexDraft&) = delete;
  IndexDraft& operator=(const IndexDraft&) = delete;

  std::uint64_t size() const { return size_; }
  /// Adds a key beyond the last one.
  void append(Key128 key);

  /// What change() tells.
  struct Listener {
    std::function<void(Key128)> added, removed;   ///< keys that were not there, and keys that were
    std::function<void(std::size_t)> has_merged;  ///< so many keys since the last call
  };
  /// Both lists are ascending, without duplicates, and disjoint. Keys that are there are not added, those that are not
  /// are not removed. Cost: linear in the changes and the keys of the pages that they fall on; one step for each other
  /// page. After an error the draft is of no use.
  void change(std::span<const Key128> added, std::span<const Key128> removed, const Listener& listener);

  /// Valid until the next change.
  PageDirectory directory() const;
  std::size_t pageCount() const { return pages_.size(); }
  std::span<const QuadKey> page(std::size_t number) const;
  /// Of all pages, also those that are kept for later changes.
  std::size_t bytes() const { return memory_.bytes(); }

 private:
  static constexpr std::size_t kMaxKeys = (DraftPages::kPageBytes - lmdb_page::kHeaderSize) / sizeof(QuadKey);

  void addPage(std::span<const Key128> keys);

  DraftPages memory_;
  std::vector<std::uint8_t*> pages_;  ///< none is empty
  std::vector<Key128> first_;         ///< the first key of each page
  std::uint64_t size_ = 0;
};

}  // namespace cluxel::rdf
