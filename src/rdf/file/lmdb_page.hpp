// SPDX-License-Identifier: Apache-2.0
// The page layout of LMDB's data format 1 (releases 0.9.x), for reading pages directly from the mapped file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace cluxel::rdf::lmdb_page {

using PageNumber = std::uint64_t;
inline constexpr PageNumber kNoPage = ~PageNumber{0};
inline constexpr std::size_t kHeaderSize = 16;
inline constexpr int kMaxDepth = 32;  ///< deeper trees occur only in damaged files
inline constexpr std::uint32_t kMagic = 0xBEEFC0DE;
inline constexpr std::uint32_t kDataVersion = 1;

enum PageFlag : std::uint16_t { kBranch = 0x01, kLeaf = 0x02, kOverflow = 0x04, kMeta = 0x08, kFixedKeys = 0x20 };
enum NodeFlag : std::uint16_t { kBigData = 0x01, kSubData = 0x02, kDupData = 0x04 };

/// The first 16 bytes of every page.
struct Header {
  PageNumber number;
  std::uint16_t pad;  ///< key size of a page of fixed keys
  std::uint16_t flags;
  std::uint16_t lower, upper;  ///< bounds of the free space; together the page count of an overflow run
};
static_assert(sizeof(Header) == kHeaderSize);

/// The root record of a B-tree (MDB_db).
struct Tree {
  std::uint32_t pad;
  std::uint16_t flags, depth;
  PageNumber branch_pages, leaf_pages, overflow_pages;
  std::uint64_t entries;
  PageNumber root;
};
static_assert(sizeof(Tree) == 48);

/// The contents of the two meta pages after the page header (MDB_meta).
struct Meta {
  std::uint32_t magic, version;
  std::uint64_t address, map_size;
  Tree free_pages, main;  ///< free_pages.pad holds the page size
  PageNumber last_page;
  std::uint64_t transaction;
};
static_assert(sizeof(Meta) == 136);

template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

inline Header header(const std::uint8_t* page) {
  return load<Header>(page);
}

/// A long value has pages of its own, of which only the first has a header.
inline std::uint64_t pagesOfLongValue(std::size_t size, std::uint64_t page_size) {
  return (kHeaderSize - 1 + size) / page_size + 1;
}

inline bool isHeadOfLongValue(const std::uint8_t* page, PageNumber number, std::uint64_t pages) {
  const Header head = header(page);
  return head.number == number && head.flags == kOverflow && (head.lower | (std::uint32_t{head.upper} << 16U)) == pages;
}

/// The number of keys of a fixed-key page, or of nodes of any other leaf or branch page.
inline std::size_t entryCount(const std::uint8_t* page) {
  return (static_cast<std::size_t>(load<std::uint16_t>(page + 12)) - kHeaderSize) / 2;
}

/// True for a page of fixed keys whose counts fit its size.
inline bool isPageOfKeys(const std::uint8_t* page, std::size_t page_size, std::size_t key_size) {
  const Header head = header(page);
  if ((head.flags & kFixedKeys) == 0 || head.pad != key_size || head.lower <= kHeaderSize || head.lower % 2 != 0)
    return false;
  const std::size_t count = entryCount(page);
  return kHeaderSize + count * key_size <= page_size && head.upper == page_size - count * (key_size - 2);
}

/// One entry of a leaf or branch page.
class Node {
 public:
  Node(const std::uint8_t* page, std::size_t i) : bytes_(page + load<std::uint16_t>(page + kHeaderSize + 2 * i)) {}
  explicit Node(const std::uint8_t* bytes) : bytes_(bytes) {}
  std::uint16_t flags() const { return load<std::uint16_t>(bytes_ + 4); }
  std::uint16_t keySize() const { return load<std::uint16_t>(bytes_ + 6); }
  const std::uint8_t* key() const { return bytes_ + 8; }
  const std::uint8_t* data() const { return key() + keySize(); }
  std::size_t dataSize() const { return load<std::uint32_t>(bytes_); }
  /// The child page of a branch node: 48 bits, of which the flags field holds the highest.
  PageNumber child() const { return load<std::uint32_t>(bytes_) | (static_cast<PageNumber>(flags()) << 32U); }

 private:
  const std::uint8_t* bytes_;
};

}  // namespace cluxel::rdf::lmdb_page
