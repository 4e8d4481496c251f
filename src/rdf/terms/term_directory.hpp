// SPDX-License-Identifier: Apache-2.0
// Locates the records of terms in a mapped commit.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "rdf/file/lmdb_page.hpp"
#include "rdf/file/page_directory.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// The leaf pages of the term database. Ids are dense, so the position of a term on its page follows from the page's
/// first id.
class TermDirectory {
 public:
  TermDirectory(const PageMap& map, const lmdb_page::Tree& table);  ///< cost: one step per leaf page
  /// The record of `id`; empty when there is none.
  std::string_view record(TermId id) const;

 private:
  struct Leaf {
    TermId first;        ///< the first id of the page
    std::uint32_t page;  ///< page number; 32 bits suffice for 16 TiB
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

  static constexpr unsigned kStrideBits = 6;
  PageMap map_;
  TermId end_ = 1;  ///< one past the last id
  std::vector<Leaf> leaves_;
  std::vector<std::uint32_t> leaf_of_;  ///< the leaf of every 64th id
};

}  // namespace cluxel::rdf
