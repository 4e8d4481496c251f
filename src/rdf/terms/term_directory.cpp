// SPDX-License-Identifier: Apache-2.0
// Builds the term directory and finds records in it.
#include "rdf/terms/term_directory.hpp"

#include <algorithm>
#include <limits>

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

constexpr std::uint64_t kNoMoreIds = 0xFFFFFFFF;

[[noreturn]] void failOnDictionary() {
  failOutside("its dictionary");
}

/// The offset of node `i` of `page`.
const std::uint8_t* offsetOf(const std::uint8_t* page, std::size_t i) {
  return page + kHeaderSize + 2 * i;
}

}  // namespace

TermDirectory::TermDirectory(const PageMap& map, const Tree& table) : map_(map) {
  if (table.leaf_pages > map.page_count || table.entries >= kNoMoreIds) failOnDictionary();
  leaves_.reserve(table.leaf_pages);
  end_ = static_cast<TermId>(table.entries) + 1;
  if (table.root != kNoPage) collect(table.root, 1, 0);
  indexIds();
}

void TermDirectory::indexIds() {
  leaf_of_.reserve((end_ >> kStrideBits) + 1);
  std::uint32_t leaf = 0;
  for (std::uint64_t id = 0; id < end_; id += std::uint64_t{1} << kStrideBits) {
    while (leaf + 1 < leaves_.size() && leaves_[leaf + 1].first <= id) ++leaf;
    leaf_of_.push_back(leaf);
  }
}

void TermDirectory::addLeaf(TermId first, PageNumber number) {
  if (number > std::numeric_limits<std::uint32_t>::max() || (!leaves_.empty() && first <= leaves_.back().first))
    failOnDictionary();
  leaves_.push_back({first, static_cast<std::uint32_t>(number)});
}

void TermDirectory::collect(PageNumber number, TermId first, int depth) {
  const std::uint8_t* page = map_.page(number);
  if (depth > kMaxDepth) failOnDictionary();
  if ((header(page).flags & kLeaf) != 0) return addLeaf(first, number);
  const std::size_t count = std::min<std::size_t>(lmdb_page::entryCount(page), map_.page_size / 2);
  bool leaves = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = load<std::uint16_t>(offsetOf(page, i));
    if (at + 8 + sizeof(TermId) > map_.page_size && (i > 0 || at + 8 > map_.page_size)) failOnDictionary();
    const Node node(page + at);
    const TermId child_first = i == 0 || node.keySize() != sizeof(TermId) ? first : load<TermId>(node.key());
    const std::uint8_t* child = map_.page(node.child());
    if (i == 0) leaves = (header(child).flags & kLeaf) != 0;
    if (leaves)
      addLeaf(child_first, node.child());
    else
      collect(node.child(), child_first, depth + 1);
  }
}

std::size_t TermDirectory::leafOf(TermId id) const {
  std::size_t leaf = leaf_of_[id >> kStrideBits];
  while (leaf + 1 < leaves_.size() && leaves_[leaf + 1].first <= id) ++leaf;
  return leaf;
}

std::string_view TermDirectory::record(TermId id) const {
  if (!has(id)) return {};
  const std::size_t leaf = leafOf(id);
  const std::uint8_t* page = pageAt(leaf);
  const std::uint8_t* offset = offsetOf(page, id - leaves_[leaf].first);
  // The page header is not read, which would often cost another cache miss: the record's key identifies it.
  if (offset > lastOffset(page)) failOnDictionary();
  const std::size_t at = load<std::uint16_t>(offset);
  if (at + 8 + sizeof(TermId) > map_.page_size) failOnDictionary();
  const Node node(page + at);
  if (node.keySize() != sizeof(TermId) || load<TermId>(node.key()) != id) failOnDictionary();
  const std::uint8_t* data = node.data();
  const std::size_t size = node.dataSize();
  if ((node.flags() & kBigData) != 0) {
    if (data + sizeof(PageNumber) > page + map_.page_size) failOnDictionary();
    const PageNumber first_page = load<PageNumber>(data);
    map_.page(first_page + (kHeaderSize + size - 1) / map_.page_size);
    data = map_.page(first_page) + kHeaderSize;
  } else if (data + size > page + map_.page_size) {
    failOnDictionary();
  }
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace cluxel::rdf
