// SPDX-License-Identifier: Apache-2.0
// Builds and searches page directories.
#include "rdf/file/page_directory.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "cluxel/error.hpp"
#include "rdf/file/check/page_guard.hpp"

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

[[noreturn]] void failOnIndex() {
  failOutside("an index");
}

const QuadKey* keysAt(const std::uint8_t* bytes) {
  return reinterpret_cast<const QuadKey*>(bytes);
}

/// Branchless lower bound among `count` keys.
std::size_t lowerBoundIn(const QuadKey* keys, std::size_t count, Key128 key) {
  const QuadKey* first = keys;
  while (count > 1) {
    const std::size_t half = count / 2;
    first += toNumber(first[half - 1]) < key ? half : 0;
    count -= half;
  }
  return static_cast<std::size_t>(first - keys) + (count == 1 && toNumber(*first) < key ? 1 : 0);
}

/// Interpolation: the expected index of a key among `count` keys distributed evenly from `low` to `high`.
std::size_t guess(Key128 low, Key128 high, Key128 key, std::size_t count) {
  // The upper halves are, for example, subject and predicate; when they are equal, the lower halves decide.
  const auto upper = [](Key128 number) { return static_cast<std::uint64_t>(number >> 64U); };
  const bool by_upper = upper(low) != upper(high);
  const auto part = [&](Key128 number) { return by_upper ? upper(number) : static_cast<std::uint64_t>(number); };
  const double span = static_cast<double>(part(high) - part(low));
  const double share = static_cast<double>(part(key) - part(low)) / span;
  return share < 1 ? static_cast<std::size_t>(share * static_cast<double>(count)) : count - 1;
}

/// Lower bound by galloping search from `start`; a good estimate touches few cache lines.
std::size_t lowerBoundNear(std::span<const QuadKey> keys, std::size_t start, Key128 key) {
  std::size_t step = 1;
  if (toNumber(keys[start]) < key) {
    std::size_t low = start;
    while (start + step < keys.size() && toNumber(keys[start + step]) < key) {
      low = start + step;
      step *= 2;
    }
    const std::size_t high = std::min(start + step, keys.size());
    return low + 1 + lowerBoundIn(keys.data() + low + 1, high - low - 1, key);
  }
  std::size_t high = start;
  while (step <= start && toNumber(keys[start - step]) >= key) {
    high = start - step;
    step *= 2;
  }
  const std::size_t low = step <= start ? start - step + 1 : 0;
  return low + lowerBoundIn(keys.data() + low, high - low, key);
}

/// All bits or none: forces a conditional move, because a mispredicted branch would wait for a cache miss.
std::size_t maskOf(bool chosen) {
  return std::size_t{0} - static_cast<std::size_t>(chosen);
}

/// The only entry of an index: its keys are the duplicates of one key.
Node indexNode(const PageMap& map, const Tree& table) {
  const std::uint8_t* root = map.page(table.root);
  if ((header(root).flags & kLeaf) == 0 || lmdb_page::entryCount(root) != 1) failOnIndex();
  const std::size_t at = load<std::uint16_t>(root + kHeaderSize);
  if (at + 8 > map.page_size) failOnIndex();
  const Node node(root, 0);
  const std::size_t room = static_cast<std::size_t>(root + map.page_size - node.data());
  if (node.data() > root + map.page_size || node.dataSize() > room) failOnIndex();
  return node;
}

/// The tree of the keys of an index that has pages of its own.
Tree keyTreeOf(const Node& node, const PageMap& map) {
  if (node.dataSize() != sizeof(Tree)) failOnIndex();
  const Tree tree = load<Tree>(node.data());
  if (tree.leaf_pages > map.page_count || tree.pad != sizeof(QuadKey)) failOnIndex();
  return tree;
}

}  // namespace

void failOutside(const char* part) {
  throw Error(ErrorKind::StoreUnavailable, std::string("the map is damaged: ") + part +
                                               " points outside the file; run `cluxel doctor` for the location");
}

const std::uint8_t* PageMap::page(PageNumber number) const {
  if (number >= page_count) failOnIndex();
  return base + number * page_size;
}

std::uint64_t leafPagesOf(const PageMap& map, const Tree& table) {
  if (table.root == kNoPage) return 0;
  const Node node = indexNode(map, table);
  return (node.flags() & kSubData) == 0 ? 0 : keyTreeOf(node, map).leaf_pages;
}

PageDirectory::PageDirectory(const PageMap& map, const Tree& table) {
  if (table.root == kNoPage) return;
  max_keys_ = (map.page_size - kHeaderSize) / sizeof(QuadKey);
  const Node node = indexNode(map, table);
  if ((node.flags() & kDupData) == 0) {
    if (node.dataSize() != sizeof(QuadKey)) failOnIndex();
    single_ = true;
    lower_.push_back(0);
    pages_.push_back(keysAt(node.data()));
  } else if ((node.flags() & kSubData) == 0) {
    if (node.dataSize() < kHeaderSize || header(node.data()).pad != sizeof(QuadKey)) failOnIndex();
    max_keys_ = (node.dataSize() - kHeaderSize) / sizeof(QuadKey);
    addPage(0, node.data());
  } else {
    const Tree tree = keyTreeOf(node, map);
    lower_.reserve(tree.leaf_pages);
    pages_.reserve(tree.leaf_pages);
    collect(map, tree.root, 0, 0);
  }
}

PageDirectory::PageDirectory(const PageDirectory& pages, std::shared_ptr<const PageGuard> guard)
    : max_keys_(pages.max_keys_), lower_(pages.lower_), pages_(pages.pages_), single_(pages.single_) {
  guardBy(std::move(guard));
}

void PageDirectory::guardBy(std::shared_ptr<const PageGuard> guard) {
  guard_ = std::move(guard);
  is_checked_ = guard_ ? std::make_unique<std::atomic<bool>[]>(pages_.size()) : nullptr;
}

/// A directory of a write transaction may have bounds of its own: the keys of the commit between them count.
void PageDirectory::check(std::size_t page) const {
  const Key128 first = page == 0 ? 0 : lower_[page];
  guard_->check(first, page + 1 < lower_.size() ? lower_[page + 1] - 1 : ~Key128{0});
  is_checked_[page].store(true, std::memory_order_relaxed);
}

void PageDirectory::addPage(Key128 lower, const std::uint8_t* page) {
  if (!lower_.empty() && lower <= lower_.back()) failOnIndex();
  lower_.push_back(lower);
  pages_.push_back(keysAt(page + kHeaderSize));
}

void PageDirectory::collect(const PageMap& map, PageNumber number, Key128 lower, int depth) {
  if (depth > kMaxDepth) failOnIndex();
  const std::uint8_t* page = map.page(number);
  if ((header(page).flags & kLeaf) != 0) return addPage(lower, page);
  const std::size_t count = lmdb_page::entryCount(page);
  if (count > map.page_size / 2) failOnIndex();
  // All children of a branch page are of one kind, so only the first is checked.
  bool leaves = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = load<std::uint16_t>(page + kHeaderSize + 2 * i);
    if (at + 8 + sizeof(QuadKey) > map.page_size && (i > 0 || at + 8 > map.page_size)) failOnIndex();
    const Node node(page + at);
    const Key128 child_lower = i == 0 || node.keySize() != sizeof(QuadKey) ? lower : toNumber(*keysAt(node.key()));
    const std::uint8_t* child = map.page(node.child());
    if (i == 0) leaves = (header(child).flags & kLeaf) != 0;
    if (leaves)
      addPage(child_lower, child);
    else
      collect(map, node.child(), child_lower, depth + 1);
  }
}

PageDirectory::PageDirectory(MDB_cursor* cursor) {
  MDB_val key;
  MDB_val first;
  if (mdb_cursor_get(cursor, &key, &first, MDB_FIRST) != MDB_SUCCESS) return;
  std::size_t duplicates = 0;
  mdb_cursor_count(cursor, &duplicates);
  MDB_val block = first;
  single_ = duplicates == 1;
  int code = single_ ? MDB_SUCCESS : mdb_cursor_get(cursor, &key, &block, MDB_GET_MULTIPLE);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(cursor, &key, &block, MDB_NEXT_MULTIPLE)) {
    const QuadKey* keys = keysAt(static_cast<const std::uint8_t*>(block.mv_data));
    lower_.push_back(lower_.empty() ? 0 : toNumber(*keys));
    pages_.push_back(keys);
    if (single_) return;
  }
}

PageDirectory::PageDirectory(std::vector<const QuadKey*> pages, std::vector<Key128> first_keys)
    : lower_(std::move(first_keys)), pages_(std::move(pages)) {
  if (!lower_.empty()) lower_.front() = 0;
}

std::size_t PageDirectory::pageOf(Key128 key) const {
  const Key128* first = lower_.data();
  std::size_t count = lower_.size();
  while (count > 1) {
    const std::size_t half = count / 2;
    first += first[half] <= key ? half : 0;
    count -= half;
  }
  return static_cast<std::size_t>(first - lower_.data());
}

PageDirectory::Position PageDirectory::within(std::size_t i, Key128 key) const {
  const std::span<const QuadKey> keys = page(i);
  if (keys.empty()) return {i + 1, 0};  // only in a damaged file
  const std::size_t index = i + 1 < pages_.size()
                                ? lowerBoundNear(keys, guess(lower_[i], lower_[i + 1], key, keys.size()), key)
                                : lowerBoundIn(keys.data(), keys.size(), key);
  return index == keys.size() ? Position{i + 1, 0} : Position{i, index};
}

PageDirectory::Position PageDirectory::lowerBound(Key128 key) const {
  if (pages_.empty()) return end();
  return within(pageOf(key), key);
}

PageDirectory::Position PageDirectory::lowerBound(Key128 key, Position hint) const {
  const std::size_t count = pages_.size();
  if (hint.page >= count || key < lower_[hint.page]) return lowerBound(key);
  if (hint.page + 1 >= count || key < lower_[hint.page + 1]) return within(hint.page, key);
  if (hint.page + 2 >= count || key < lower_[hint.page + 2]) return within(hint.page + 1, key);
  return lowerBound(key);
}

void PageDirectory::lowerBounds(std::span<const Key128> keys, std::span<Position> found) const {
  for (std::size_t at = 0; at < keys.size(); at += kTogether) {
    const std::size_t count = std::min(kTogether, keys.size() - at);
    lowerBoundsOfGroup(keys.subspan(at, count), found.subspan(at, count));
  }
}

void PageDirectory::lowerBoundsOfGroup(std::span<const Key128> keys, std::span<Position> found) const {
  if (pages_.empty()) return std::fill(found.begin(), found.end(), end());
  const auto [min, max] = std::minmax_element(keys.begin(), keys.end());
  const std::size_t first = pageOf(*min), last = pageOf(*max);
  for (Position& position : found) position.page = first;
  for (std::size_t count = last - first + 1; count > 1; count -= count / 2) {
    const std::size_t half = count / 2;
    for (std::size_t k = 0; k < keys.size(); ++k)
      found[k].page += half & maskOf(lower_[found[k].page + half] <= keys[k]);
  }
  for (const Position& position : found) {
    const auto* page = reinterpret_cast<const std::uint8_t*>(pages_[position.page]);
    if (!single_) __builtin_prefetch(page - lmdb_page::kHeaderSize);
    __builtin_prefetch(page + max_keys_ / 2 * sizeof(QuadKey));
  }
  searchPages(keys, found);
}

/// lowerBoundIn() for each key on its page.
void PageDirectory::searchPages(std::span<const Key128> keys, std::span<Position> found) const {
  std::array<const QuadKey*, kTogether> starts;
  std::array<std::size_t, kTogether> counts;
  std::size_t largest = 0;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto entries = page(found[k].page);
    starts[k] = entries.data();
    counts[k] = entries.size();
    largest = std::max(largest, entries.size());
  }
  for (; largest > 1; largest -= largest / 2) {
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const std::size_t half = counts[k] / 2;
      const QuadKey& middle = starts[k][half - static_cast<std::size_t>(half > 0)];
      starts[k] += half & maskOf(toNumber(middle) < keys[k]);
      counts[k] -= half;
    }
  }
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto entries = page(found[k].page);
    found[k].index = static_cast<std::size_t>(starts[k] - entries.data());
    if (counts[k] == 1 && toNumber(*starts[k]) < keys[k]) ++found[k].index;
    if (found[k].index == entries.size()) found[k] = {found[k].page + 1, 0};
  }
}

std::uint64_t PageDirectory::distance(Position from, Position to) const {
  if (from.page == to.page) return to.index - from.index;
  std::uint64_t count = page(from.page).size() - from.index + to.index;
  for (std::size_t i = from.page + 1; i < to.page; ++i) count += page(i).size();
  return count;
}

}  // namespace cluxel::rdf
