// SPDX-License-Identifier: Apache-2.0
// Walks the B-trees of a commit on a mapping of its own, with every number checked before it is used.
#include "rdf/file/check/map_structure.hpp"

#include <algorithm>
#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rdf/file/check/file_mapping.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/lmdb_environment.hpp"

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

constexpr std::uint32_t kIndexKeySize = 16;

enum class TreeKind : std::uint8_t { Main, Free, Blocks, Terms, Index, IndexKeys };

TreeKind kindOf(Table table) {
  if (table == Table::Blocks) return TreeKind::Blocks;
  return table == Table::Terms ? TreeKind::Terms : TreeKind::Index;
}

std::strong_ordering compareKeys(TreeKind kind, std::string_view a, std::string_view b) {
  const auto asBytes = [](std::string_view key) { return reinterpret_cast<const std::uint8_t*>(key.data()); };
  if (kind == TreeKind::Terms) return load<std::uint32_t>(asBytes(a)) <=> load<std::uint32_t>(asBytes(b));
  if (kind == TreeKind::Free) return load<std::uint64_t>(asBytes(a)) <=> load<std::uint64_t>(asBytes(b));
  return a <=> b;
}

bool hasKeySize(TreeKind kind, std::size_t size) {
  switch (kind) {
    case TreeKind::Terms:
      return size == sizeof(std::uint32_t);
    case TreeKind::Free:
      return size == sizeof(std::uint64_t);
    case TreeKind::IndexKeys:
      return size == kIndexKeySize;
    default:
      return size > 0;
  }
}

std::size_t even(std::size_t size) {
  return (size + 1) & ~std::size_t{1};
}

/// The keys of a subtree are at least `low` and less than `high`.
struct KeyBounds {
  std::optional<std::string_view> low, high;
};

/// Visits every page of the trees of one commit.
class StructureWalk {
 public:
  StructureWalk(const std::uint8_t* bytes, const std::filesystem::path& file, const MapFileHead& head, const Meta& meta,
                MapScope scope)
      : bytes_(bytes),
        file_(file),
        page_size_(head.page_size),
        file_pages_(head.file_size / head.page_size),
        meta_(meta),
        scope_(scope),
        seen_(std::min(meta.last_page + 1, file_pages_)) {}

  PresentKeys run() {
    tree(meta_.free_pages, TreeKind::Free);
    tree(meta_.main, TreeKind::Main);
    for (const std::string_view list : free_lists_) freeList(list);
    // LMDB leaves out pages behind the last used one when it writes, so all that the file lacks are free.
    if (scope_ != MapScope::Reading && meta_.last_page >= file_pages_ + free_count_ + 1)
      refuseDamaged(file_, "its head names a page beyond the end");
    return std::move(block_keys_);
  }

 private:
  /// What the walk of one tree has met, in the terms of its record.
  struct Walked {
    TreeKind kind;
    std::size_t known_depth = 0;  ///< of leaves that are not read; 0: all are
    std::uint64_t branch_pages = 0, leaf_pages = 0, overflow_pages = 0, entries = 0;
    std::size_t depth = 0;
  };

  std::uint64_t tree(const Tree& record, TreeKind kind) {
    const bool skips_leaves = scope_ == MapScope::Writing && hasUnreadLeaves(record, kind);
    Walked walked{.kind = kind, .known_depth = skips_leaves ? record.depth : std::size_t{0}};
    if (record.root != kNoPage) page(record.root, 1, {}, walked);
    if (walked.branch_pages != record.branch_pages || walked.leaf_pages != record.leaf_pages ||
        walked.overflow_pages != record.overflow_pages || walked.depth != record.depth ||
        (!skips_leaves && walked.entries != record.entries))
      refuseDamaged(file_, "a table holds more or less than its record states");
    return record.entries;
  }

  /// A writer appends terms: LMDB reads the last of their leaves only. When some term is long, all are read: they tell
  /// which pages its value takes.
  static bool hasUnreadLeaves(const Tree& record, TreeKind kind) {
    return kind == TreeKind::IndexKeys || (kind == TreeKind::Terms && record.overflow_pages == 0);
  }

  void page(PageNumber number, std::size_t depth, const KeyBounds& bounds, Walked& walked) {
    if (depth > kMaxDepth) refuse(number, "lies too deep");
    const bool is_last_of_terms = walked.kind == TreeKind::Terms && !bounds.high;
    if (depth == walked.known_depth && !is_last_of_terms) {
      if (number >= seen_.size()) refuse(number, "lies beyond the end: the file is cut short");
      mark(number);
      walked.depth = depth;
      ++walked.leaf_pages;
      return;
    }
    const std::uint8_t* bytes = take(number);
    const Header head = header(bytes);
    if (head.lower <= kHeaderSize || head.lower > page_size_ || head.lower % 2 != 0 || head.lower > head.upper ||
        head.upper > page_size_)
      refuse(number, "has wrong bounds");
    if (head.flags == kBranch) return branch(number, bytes, depth, bounds, walked);
    if (walked.depth != 0 && walked.depth != depth) refuse(number, "lies at another depth than its neighbours");
    walked.depth = depth;
    ++walked.leaf_pages;
    const std::size_t count = entryCount(bytes);
    if (head.flags == (kLeaf | kFixedKeys)) {
      if (walked.kind != TreeKind::IndexKeys || !isPageOfKeys(bytes, page_size_, kIndexKeySize))
        refuse(number, "has malformed keys");
      walked.entries += count;
      return;
    }
    if (head.flags != kLeaf || walked.kind == TreeKind::IndexKeys) refuse(number, "is of the wrong kind");
    nodes(number, bytes, false, bounds, walked.kind);
    for (std::size_t i = 0; i < count; ++i) walked.entries += leafNode(number, Node(bytes, i), walked);
  }

  void branch(PageNumber number, const std::uint8_t* bytes, std::size_t depth, const KeyBounds& bounds,
              Walked& walked) {
    ++walked.branch_pages;
    nodes(number, bytes, true, bounds, walked.kind);
    const std::size_t count = entryCount(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      const KeyBounds inner{i == 0 ? bounds.low : std::optional(keyOf(Node(bytes, i))),
                            i + 1 == count ? bounds.high : std::optional(keyOf(Node(bytes, i + 1)))};
      page(Node(bytes, i).child(), depth + 1, inner, walked);
    }
  }

  static std::string_view keyOf(const Node& node) {
    return {reinterpret_cast<const char*>(node.key()), node.keySize()};
  }

  /// The nodes of a page lie within it, fill it from the end without gaps, and their keys ascend within the bounds.
  /// Readers find out of order keys of blocks by their sum, so that the other blocks can still be read.
  void nodes(PageNumber number, const std::uint8_t* bytes, bool is_branch, const KeyBounds& bounds, TreeKind kind) {
    const std::size_t count = entryCount(bytes), upper = header(bytes).upper;
    const bool may_be_unordered = scope_ == MapScope::Reading && kind == TreeKind::Blocks;
    std::size_t used = 0, before = page_size_;
    bool in_a_row = true;  // as LMDB appends entries: from the end of the page, each before the last one
    std::optional<std::string_view> last;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = load<std::uint16_t>(bytes + kHeaderSize + 2 * i);
      if (at < upper || at + 8 > page_size_) refuse(number, "has an entry outside itself");
      const Node node(bytes, i);
      const std::size_t size = nodeSize(node, is_branch);
      if (at + even(size) > page_size_) refuse(number, "has an entry outside itself");
      used += even(size);
      in_a_row = in_a_row && at + even(size) == before;
      before = at;
      if (is_branch && i == 0) continue;  // its key is not used
      const std::string_view key = keyOf(node);
      if (!hasKeySize(kind, key.size())) refuse(number, "has a key of a wrong size");
      if ((last && compareKeys(kind, key, *last) <= 0) || (bounds.low && compareKeys(kind, key, *bounds.low) < 0) ||
          (bounds.high && compareKeys(kind, key, *bounds.high) >= 0)) {
        if (!may_be_unordered) refuse(number, "has keys out of order");
        block_keys_.in_order = false;
      }
      last = key;
    }
    if (used != page_size_ - upper) refuse(number, "has gaps between its entries");
    if (scope_ != MapScope::Reading && !in_a_row) requireDisjoint(number, bytes, is_branch);
  }

  static std::size_t nodeSize(const Node& node, bool is_branch) {
    const std::size_t head = 8 + std::size_t{node.keySize()};
    if (is_branch) return head;
    return head + ((node.flags() & kBigData) != 0 ? sizeof(PageNumber) : node.dataSize());
  }

  void requireDisjoint(PageNumber number, const std::uint8_t* bytes, bool is_branch) {
    const std::size_t count = entryCount(bytes);
    size_at_.resize(page_size_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = load<std::uint16_t>(bytes + kHeaderSize + 2 * i);
      size_at_[at] = static_cast<std::uint16_t>(even(nodeSize(Node(bytes, i), is_branch)));
    }
    // They fill the page, as was found out before, so without overlaps each ends where the next one begins.
    std::size_t met = 0, at = header(bytes).upper;
    for (; at < page_size_ && size_at_[at] != 0; ++met) at += std::exchange(size_at_[at], 0);
    if (met != count || at != page_size_) refuse(number, "has entries that overlap");
  }

  /// The number of entries that a node stands for.
  std::uint64_t leafNode(PageNumber number, const Node& node, Walked& walked) {
    if (walked.kind == TreeKind::Blocks) block_keys_.add(keyOf(node));
    const bool may_be_big = walked.kind != TreeKind::Main && walked.kind != TreeKind::Index;
    if (may_be_big && node.flags() == kBigData)
      bigValue(number, node, walked);
    else if (walked.kind == TreeKind::Index)
      return indexNode(number, node);
    else if (walked.kind == TreeKind::Main && node.flags() == kSubData)
      table(number, node);
    else if (node.flags() != 0)
      refuse(number, "has an entry of the wrong kind");
    if (walked.kind == TreeKind::Free)
      free_lists_.emplace_back(reinterpret_cast<const char*>(dataOf(node)), node.dataSize());
    return 1;
  }

  const std::uint8_t* dataOf(const Node& node) const {
    if ((node.flags() & kBigData) == 0) return node.data();
    return bytes_ + load<PageNumber>(node.data()) * page_size_ + kHeaderSize;
  }

  /// LMDB takes the flags of a database from its record, not from the call that opens it.
  void table(PageNumber number, const Node& node) {
    if (node.dataSize() != sizeof(Tree)) refuse(number, "has a malformed record of a table");
    const Tree record = load<Tree>(node.data());
    for (std::size_t i = 0; i < kTableCount; ++i) {
      if (keyOf(node) != kTableNames[i]) continue;
      const auto which = static_cast<Table>(i);
      if (record.flags != tableFlags(which) || record.pad != 0 || record.depth > kMaxDepth)
        refuse(number, "has a table of the wrong kind");
      if (scope_ != MapScope::Reading || which == Table::Blocks) tree(record, kindOf(which));
      return;
    }
    if (scope_ != MapScope::Reading) refuse(number, "has an unknown table");
  }

  /// The entries of an index are the duplicates of one key: one in the node, some in an inner page, or many in a tree.
  std::uint64_t indexNode(PageNumber number, const Node& node) {
    if (node.flags() == 0 && node.dataSize() == kIndexKeySize) return 1;
    if (node.flags() == kDupData) {
      if (node.dataSize() < kHeaderSize || !isPageOfKeys(node.data(), node.dataSize(), kIndexKeySize))
        refuse(number, "has a malformed inner page");
      return entryCount(node.data());
    }
    if (node.flags() != (kDupData | kSubData) || node.dataSize() != sizeof(Tree))
      refuse(number, "has an entry of the wrong kind");
    const Tree record = load<Tree>(node.data());
    if (record.pad != kIndexKeySize || record.flags != MDB_DUPFIXED) refuse(number, "has keys of a wrong size");
    return tree(record, TreeKind::IndexKeys);
  }

  void bigValue(PageNumber holder, const Node& node, Walked& walked) {
    const auto first = load<PageNumber>(node.data());
    const std::uint64_t pages = pagesOfLongValue(node.dataSize(), page_size_);
    if (node.dataSize() == 0 || first >= seen_.size() || pages > seen_.size() - first)
      refuse(holder, "has a value beyond the end: the file is cut short");
    const bool is_looked_at = scope_ == MapScope::Whole || walked.kind != TreeKind::Blocks;
    if (is_looked_at && !isHeadOfLongValue(bytes_ + first * page_size_, first, pages))
      refuse(first, "is of the wrong kind");
    for (std::uint64_t i = 0; i < pages; ++i) mark(first + i);
    walked.overflow_pages += pages;
  }

  /// A list holds its length and then page numbers, descending.
  void freeList(std::string_view list) {
    const auto* words = reinterpret_cast<const std::uint8_t*>(list.data());
    const std::size_t count = list.size() / sizeof(PageNumber);
    if (count == 0 || list.size() % sizeof(PageNumber) != 0 || load<PageNumber>(words) >= count)
      refuseDamaged(file_, "its list of free pages is malformed");
    const auto listed = static_cast<std::size_t>(load<PageNumber>(words));
    PageNumber last = meta_.last_page + 1;
    for (std::size_t i = 1; i <= listed; ++i) {
      const auto number = load<PageNumber>(words + i * sizeof(PageNumber));
      if (number < 2 || number >= last) refuseDamaged(file_, "its list of free pages is out of order");
      if (number < seen_.size()) mark(number);  // pages behind the end were never written
      last = number;
    }
    free_count_ += listed;
  }

  const std::uint8_t* take(PageNumber number) {
    if (number >= seen_.size()) refuse(number, "lies beyond the end: the file is cut short");
    mark(number);
    const std::uint8_t* bytes = bytes_ + number * page_size_;
    if (header(bytes).number != number) refuse(number, "is of the wrong kind");
    return bytes;
  }

  void mark(PageNumber number) {
    if (number < 2 || seen_[number]) refuse(number, "is used twice");
    seen_[number] = true;
  }

  [[noreturn]] void refuse(PageNumber number, const std::string& what) const {
    refuseDamaged(file_, "page " + std::to_string(number) + " " + what);
  }

  const std::uint8_t* bytes_;
  const std::filesystem::path& file_;
  std::uint64_t page_size_, file_pages_;
  const Meta& meta_;
  MapScope scope_;
  std::vector<bool> seen_;
  PresentKeys block_keys_;
  std::vector<std::string_view> free_lists_;
  std::uint64_t free_count_ = 0;
  std::vector<std::uint16_t> size_at_;  ///< of the entries of a page, by where they begin; empty between pages
};

}  // namespace

PresentKeys checkMapStructure(int descriptor, const std::filesystem::path& file, std::uint64_t transaction,
                              MapScope scope, const std::uint8_t* mapped) {
  const MapFileHead head = readMapFileHead(descriptor, file);
  const Meta* meta = head.metaOf(transaction);
  if (meta == nullptr) refuseFile(file, "the map changed while it was checked; run again");
  std::optional<FileMapping> own;
  if (mapped == nullptr) mapped = own.emplace(descriptor, head.file_size, file).bytes();
  return StructureWalk(mapped, file, head, *meta, scope).run();
}

}  // namespace cluxel::rdf
