// SPDX-License-Identifier: Apache-2.0
// An index in memory: what a transaction that changes most of an index reads and changes until it commits.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "rdf/file/page_directory.hpp"

namespace cluxel::rdf {

/// Sorted keys in pages that are laid out as LMDB's, so that page directories read them as they read the file. Single
/// changes cost the move of half a page.
class IndexDraft {
 public:
  IndexDraft() = default;
  IndexDraft(const IndexDraft&) = delete;
  IndexDraft& operator=(const IndexDraft&) = delete;

  std::uint64_t size() const { return size_; }
  /// Adds a key beyond the last one.
  void append(Key128 key);
  bool insert(Key128 key);  ///< false when the key was there
  bool remove(Key128 key);  ///< false when it was not

  /// Valid until the next change.
  PageDirectory directory() const;
  std::size_t pageCount() const { return pages_.size(); }
  std::span<const QuadKey> page(std::size_t number) const { return pages_[number]->keys(); }

 private:
  struct Page {
    static constexpr std::size_t kBytes = 4096, kMaxKeys = (kBytes - lmdb_page::kHeaderSize) / sizeof(QuadKey);

    std::size_t size() const { return lmdb_page::entryCount(bytes.data()); }
    void setSize(std::size_t count);
    QuadKey* first() { return reinterpret_cast<QuadKey*>(bytes.data() + lmdb_page::kHeaderSize); }
    std::span<const QuadKey> keys() const {
      return {reinterpret_cast<const QuadKey*>(bytes.data() + lmdb_page::kHeaderSize), size()};
    }
    std::array<std::uint8_t, kBytes> bytes;
  };
  struct Place {
    std::size_t page = 0, index = 0;
    bool is_there = false;
  };

  void addPage(std::size_t before);
  Place placeOf(Key128 key) const;
  void split(std::size_t page);

  std::vector<std::unique_ptr<Page>> pages_;  ///< none is empty
  std::vector<Key128> first_;                 ///< the first key of each page
  std::uint64_t size_ = 0;
};

}  // namespace cluxel::rdf
