// SPDX-License-Identifier: Apache-2.0
// Building the directory of terms and finding records in it.
#include "knowledge/term_directory.hpp"

#include <algorithm>
#include <limits>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

namespace {

using namespace lmdb_page;

constexpr int kMaxDepth = 32;
constexpr std::uint64_t kNoMoreIds = 0xFFFFFFFF;

[[noreturn]] void damaged() {
  throw Error(ExitCode::StoreUnavailable,
              "the map is damaged: its dictionary points outside the file; `cluxel doctor` tells where");
}

/// Where page `page` says its node `i` begins.
const std::uint8_t* offsetOf(const std::uint8_t* page, std::size_t i) {
  return page + kHeaderSize + 2 * i;
}

}  // namespace

TermDirectory::TermDirectory(const PageMap& map, const Tree& table) : map_(map) {
  if (table.leaf_pages > map.page_count || table.entries >= kNoMoreIds) damaged();
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
  if (number > std::numeric_limits<std::uint32_t>::max()) damaged();
  leaves_.push_back({first, static_cast<std::uint32_t>(number)});
}

void TermDirectory::collect(PageNumber number, TermId first, int depth) {
  const std::uint8_t* page = map_.page(number);
  if (depth > kMaxDepth) damaged();
  if ((header(page).flags & kLeaf) != 0) return addLeaf(first, number);
  const std::size_t count = std::min<std::size_t>(lmdb_page::entryCount(page), map_.page_size / 2);
  bool leaves = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = load<std::uint16_t>(offsetOf(page, i));
    if (at + 8 + sizeof(TermId) > map_.page_size && (i > 0 || at + 8 > map_.page_size)) damaged();
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
  const std::size_t i = id - leaves_[leaf].first;
  if (i >= lmdb_page::entryCount(page)) return {};
  const std::size_t at = load<std::uint16_t>(offsetOf(page, i));
  if (at + 8 + sizeof(TermId) > map_.page_size) damaged();
  const Node node(page + at);
  if (node.keySize() != sizeof(TermId) || load<TermId>(node.key()) != id) damaged();
  const std::uint8_t* data = node.data();
  const std::size_t size = node.dataSize();
  if ((node.flags() & kBigData) != 0) {
    const PageNumber first_page = load<PageNumber>(data);
    map_.page(first_page + (kHeaderSize + size - 1) / map_.page_size);
    data = map_.page(first_page) + kHeaderSize;
  } else if (data + size > page + map_.page_size) {
    damaged();
  }
  return {reinterpret_cast<const char*>(data), size};
}

void TermDirectory::expect(std::span<const TermId> ids) const {
  while (!ids.empty()) {
    const std::size_t now = std::min(ids.size(), kTogether);
    expectGroup(ids.first(now));
    ids = ids.subspan(now);
  }
}

/// Read by read for all of them, so that the waits overlap.
void TermDirectory::expectGroup(std::span<const TermId> ids) const {
  std::array<TermId, kTogether> known;
  std::array<const std::uint8_t*, kTogether> pages, offsets;
  std::size_t count = 0;
  for (const TermId id : ids) {
    if (!has(id)) continue;
    known[count++] = id;
    __builtin_prefetch(&leaf_of_[id >> kStrideBits]);
  }
  for (std::size_t k = 0; k < count; ++k) __builtin_prefetch(&leaves_[leaf_of_[known[k] >> kStrideBits]]);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t leaf = leafOf(known[k]);
    pages[k] = pageAt(leaf);
    const std::uint8_t* offset = offsetOf(pages[k], known[k] - leaves_[leaf].first);
    // A damaged directory may mean an entry behind the page; record() finds out.
    offsets[k] = std::min(offset, pages[k] + map_.page_size - sizeof(std::uint16_t));
    __builtin_prefetch(pages[k]);
    __builtin_prefetch(offsets[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t* node = pages[k] + load<std::uint16_t>(offsets[k]);
    __builtin_prefetch(node);
    __builtin_prefetch(node + 64);   // most records are shorter than a cache line, but do not begin with one
  }
}

}  // namespace cluxel
