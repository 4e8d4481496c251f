// SPDX-License-Identifier: Apache-2.0
// Checks the page structure of a map file with bounded reads.
#include "rdf/store/map_file_check.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/store/lmdb_environment.hpp"
#include "rdf/store/lmdb_page.hpp"
#include "rdf/store/map_check.hpp"

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

constexpr std::uint64_t kSmallFile = 8U << 20U;
constexpr std::size_t kProbe = 4096;
constexpr std::uint64_t kIndexKeySize = 16;
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 46U;

[[noreturn]] void refuseFile(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::StoreUnavailable, file.string() + ": " + what);
}

bool readAt(int descriptor, std::uint64_t offset, std::uint8_t* bytes, std::size_t size) {
  return ::pread(descriptor, bytes, size, static_cast<off_t>(offset)) == static_cast<ssize_t>(size);
}

bool plausiblePageSize(std::uint64_t size) {
  return std::has_single_bit(size) && size >= 512 && size <= 65536;
}

std::optional<Meta> readMeta(int descriptor, std::uint64_t offset) {
  std::array<std::uint8_t, kHeaderSize + sizeof(Meta)> bytes{};
  if (!readAt(descriptor, offset, bytes.data(), bytes.size())) return std::nullopt;
  if ((header(bytes.data()).flags & kMeta) == 0) return std::nullopt;
  const Meta meta = load<Meta>(bytes.data() + kHeaderSize);
  if (meta.magic != kMagic || !plausiblePageSize(meta.free_pages.pad)) return std::nullopt;
  return meta;
}

/// Visits every page of the trees of one commit.
class StructureWalk {
 public:
  StructureWalk(int descriptor, const std::filesystem::path& file, const Meta& meta, std::uint64_t file_size)
      : descriptor_(descriptor),
        file_(file),
        page_size_(meta.free_pages.pad),
        page_limit_(std::min<std::uint64_t>(meta.last_page + 1, file_size / meta.free_pages.pad)),
        seen_(page_limit_) {}

  void tree(PageNumber root, int depth, std::uint32_t fixed_key_size, bool holds_trees) {
    if (root == kNoPage) return;
    if (depth > kMaxDepth) refuse(root, "lies too deep");
    const std::vector<std::uint8_t> page = take(root);
    const Header head = header(page.data());
    const std::uint16_t kind = head.flags & (kBranch | kLeaf | kOverflow | kMeta);
    if (kind != kBranch && kind != kLeaf) refuse(root, "is of the wrong kind");
    if (head.lower < kHeaderSize || head.lower > page_size_ || head.lower % 2 != 0) refuse(root, "has a wrong count");
    const std::size_t count = entryCount(page.data());
    if (count == 0) refuse(root, "is empty");
    if ((head.flags & kFixedKeys) != 0) return fixedKeys(root, head, count, fixed_key_size);
    if (head.lower > head.upper || head.upper > page_size_) refuse(root, "has wrong bounds");
    for (std::size_t i = 0; i < count; ++i) node(root, page, i, kind == kBranch, depth, fixed_key_size, holds_trees);
  }

 private:
  void node(PageNumber number, const std::vector<std::uint8_t>& page, std::size_t i, bool branch, int depth,
            std::uint32_t fixed_key_size, bool holds_trees) {
    const std::size_t at = load<std::uint16_t>(page.data() + kHeaderSize + 2 * i);
    if (at < kHeaderSize || at + 8 > page_size_) refuse(number, "has an entry outside itself");
    const Node entry(page.data() + at);
    const std::size_t room = page_size_ - at - 8;
    if (entry.keySize() > room) refuse(number, "has a key outside itself");
    if (branch) return tree(entry.child(), depth + 1, fixed_key_size, holds_trees);
    leafNode(number, entry, room - entry.keySize(), depth, holds_trees);
  }

  void leafNode(PageNumber number, const Node& entry, std::size_t room, int depth, bool holds_trees) {
    if ((entry.flags() & kBigData) != 0) {
      if (room < sizeof(PageNumber)) refuse(number, "has a value outside itself");
      return bigValue(load<PageNumber>(entry.data()), entry.dataSize());
    }
    if (entry.dataSize() > room) refuse(number, "has a value outside itself");
    if ((entry.flags() & kSubData) == 0) {
      if ((entry.flags() & kDupData) != 0) subPage(number, entry);
      return;
    }
    if (entry.dataSize() != sizeof(Tree)) refuse(number, "has a malformed tree record");
    const Tree sub = load<Tree>(entry.data());
    if (holds_trees == ((entry.flags() & kDupData) != 0)) refuse(number, "has a tree where a value belongs");
    if (holds_trees) checkTable(number, entry, sub);
    if (!holds_trees && sub.pad != kIndexKeySize) refuse(number, "has keys of a wrong size");
    tree(sub.root, depth + 1, sub.pad, false);
  }

  /// LMDB takes the flags of a database from its record, not from the call that opens it.
  void checkTable(PageNumber number, const Node& entry, const Tree& sub) const {
    const std::string_view name(reinterpret_cast<const char*>(entry.key()), entry.keySize());
    for (std::size_t i = 0; i < kTableCount; ++i)
      if (name == kTableNames[i] && sub.flags != tableFlags(static_cast<Table>(i)))
        refuse(number, "has a table of the wrong kind");
  }

  void subPage(PageNumber number, const Node& entry) {
    if (entry.dataSize() < kHeaderSize) refuse(number, "has a malformed inner page");
    const Header head = header(entry.data());
    if ((head.flags & kFixedKeys) == 0 || head.lower < kHeaderSize) refuse(number, "has a malformed inner page");
    if (kHeaderSize + entryCount(entry.data()) * head.pad > entry.dataSize())
      refuse(number, "has a malformed inner page");
  }

  void fixedKeys(PageNumber number, const Header& head, std::size_t count, std::uint32_t key_size) {
    if (key_size == 0 || head.pad != key_size || kHeaderSize + count * key_size > page_size_)
      refuse(number, "has more keys than it holds");
  }

  void bigValue(PageNumber first, std::uint64_t size) {
    const std::uint64_t pages = (kHeaderSize + size + page_size_ - 1) / page_size_;
    if (first >= page_limit_ || pages > page_limit_ - first)
      refuse(first, "lies beyond the end: the file is cut short");
    std::array<std::uint8_t, kHeaderSize> head{};
    if (!readAt(descriptor_, first * page_size_, head.data(), head.size())) refuse(first, "cannot be read");
    if (header(head.data()).number != first || (header(head.data()).flags & kOverflow) == 0)
      refuse(first, "is of the wrong kind");
    for (std::uint64_t i = 0; i < pages; ++i) mark(first + i);
  }

  std::vector<std::uint8_t> take(PageNumber number) {
    if (number >= page_limit_) refuse(number, "lies beyond the end: the file is cut short");
    mark(number);
    std::vector<std::uint8_t> page(page_size_);
    if (!readAt(descriptor_, number * page_size_, page.data(), page.size())) refuse(number, "cannot be read");
    if (header(page.data()).number != number) refuse(number, "is of the wrong kind");
    return page;
  }

  void mark(PageNumber number) {
    if (number < 2 || seen_[number]) refuse(number, "is reached twice");
    seen_[number] = true;
  }

  [[noreturn]] void refuse(PageNumber number, const std::string& what) const {
    refuseFile(file_,
               "the map is damaged: page " + std::to_string(number) + " " + what + "; take a copy or build it again");
  }

  int descriptor_;
  const std::filesystem::path& file_;
  std::uint64_t page_size_, page_limit_;
  std::vector<bool> seen_;
};

std::uint64_t fileSize(int descriptor, const std::filesystem::path& file) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) refuseFile(file, "cannot be examined");
  if (!S_ISREG(status.st_mode)) refuseFile(file, "is not a file, a map was expected");
  return static_cast<std::uint64_t>(status.st_size);
}

/// The meta pages are pages 0 and 1.
std::array<std::optional<Meta>, 2> readMetas(int descriptor) {
  std::array<std::optional<Meta>, 2> metas{readMeta(descriptor, 0), std::nullopt};
  const std::uint64_t page_size = metas[0] ? metas[0]->free_pages.pad : kProbe;
  metas[1] = readMeta(descriptor, page_size);
  return metas;
}

}  // namespace

MapFileHead readMapFileHead(int descriptor, const std::filesystem::path& file) {
  MapFileHead head;
  const std::array<std::optional<Meta>, 2> metas = readMetas(descriptor);
  head.file_size = fileSize(descriptor, file);
  if (head.file_size == 0) return head;
  if (!metas[0] || !metas[1]) refuseFile(file, "is not a Cluxel map, or its head is damaged");
  for (const auto& meta : metas) {
    if (meta->version != kDataVersion)
      refuseFile(file, "was written by another data format of LMDB; open it with the program that wrote it");
    if (meta->free_pages.pad != metas[0]->free_pages.pad) refuseFile(file, "is a map with a damaged head");
  }
  const Meta& newest = metas[0]->transaction >= metas[1]->transaction ? *metas[0] : *metas[1];
  head.page_size = newest.free_pages.pad;
  head.last_page = newest.last_page;
  head.transaction = newest.transaction;
  if (newest.last_page > kMaxBytes / head.page_size) refuseFile(file, "is a map with a damaged head");
  for (const PageNumber root : {newest.main.root, newest.free_pages.root})
    if (root != kNoPage && (root > newest.last_page || (root + 1) * head.page_size > head.file_size))
      refuseFile(file, "the map is damaged: it is cut short; take a copy or build it again");
  return head;
}

bool needsStructureCheck(const MapFileHead& head) {
  return head.file_size <= kSmallFile || head.last_page >= head.file_size / head.page_size;
}

void checkMapStructure(int descriptor, const std::filesystem::path& file, std::uint64_t transaction) {
  const std::uint64_t file_size = fileSize(descriptor, file);
  for (const std::optional<Meta>& meta : readMetas(descriptor)) {
    if (!meta || meta->transaction != transaction) continue;
    StructureWalk walk(descriptor, file, *meta, file_size);
    walk.tree(meta->free_pages.root, 0, 0, false);
    walk.tree(meta->main.root, 0, 0, true);
    return;
  }
  refuseFile(file, "the map changed while it was checked; run again");
}

bool looksLikeMap(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool has_head = readMeta(descriptor, 0).has_value();
  ::close(descriptor);
  return has_head;
}

}  // namespace cluxel::rdf
