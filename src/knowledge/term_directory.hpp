// SPDX-License-Identifier: Apache-2.0
// Where the records of terms lie in a mapped commit.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"
#include "knowledge/lmdb_page.hpp"
#include "knowledge/page_directory.hpp"

namespace cluxel {

/// The leaf pages of the term table of a mapped commit: ids are dense, so a term's place follows from its
/// page's first.
class TermDirectory {
 public:
  TermDirectory(const PageMap& map, const lmdb_page::Tree& table);  ///< cost: one step per leaf page
  /// The record of `id`; empty when there is none.
  std::string_view record(TermId id) const;
  /// Asks the memory for the records of terms that are wanted soon, of many at once: a record lies behind four
  /// reads of which each needs the one before, and in a great map each waits for the main memory. Changes nothing.
  void expect(std::span<const TermId> ids) const;

 private:
  struct Leaf {
    TermId first;        ///< the first id of the page
    std::uint32_t page;  ///< its number: 32 bits reach 16 TiB
  };
  void collect(lmdb_page::PageNumber number, TermId first, int depth);
  void addLeaf(TermId first, lmdb_page::PageNumber number);
  void indexIds();
  std::size_t leafOf(TermId id) const;
  bool has(TermId id) const { return id != kNoTerm && id < end_ && !leaves_.empty(); }
  const std::uint8_t* lastOffset(const std::uint8_t* page) const {
    return page + map_.page_size - sizeof(std::uint16_t);
  }
  const std::uint8_t* pageAt(std::size_t leaf) const { return map_.base + leaves_[leaf].page * map_.page_size; }

  static constexpr std::size_t kTogether = 32;  ///< terms between the reads of two steps
  static constexpr unsigned kStrideBits = 6;
  PageMap map_;
  TermId end_ = 1;  ///< behind the last id
  std::vector<Leaf> leaves_;
  std::vector<std::uint32_t> leaf_of_;  ///< the leaf of every 64th id
};

}  // namespace cluxel
