// SPDX-License-Identifier: Apache-2.0
// Reads and checks the meta pages with bounded reads.
#include "rdf/file/check/map_file_head.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <thread>

#include "cluxel/error.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/map_check.hpp"

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

constexpr std::size_t kProbe = 4096;
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 46U;
/// The flags of a database that decide how LMDB compares its keys.
constexpr unsigned kOrderFlags = 0x7F;

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

using Metas = std::array<std::optional<Meta>, 2>;

/// LMDB writes commit n to meta page n % 2, so the two hold consecutive commits.
bool areConsecutive(const Meta& even, const Meta& odd) {
  const std::uint64_t first = std::min(even.transaction, odd.transaction);
  const std::uint64_t last = std::max(even.transaction, odd.transaction);
  if (last == 0) return true;  // a new file
  return last == first + 1 && even.transaction % 2 == 0;
}

/// Another process may commit between the two reads.
Metas readConsecutiveMetas(int descriptor) {
  constexpr int kAttempts = 5;
  Metas metas = readMetas(descriptor);
  for (int i = 1; i < kAttempts && metas[0] && metas[1] && !areConsecutive(*metas[0], *metas[1]); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    metas = readMetas(descriptor);
  }
  return metas;
}

void checkMeta(const Meta& meta, const MapFileHead& head, const std::filesystem::path& file) {
  if (meta.version != kDataVersion)
    refuseFile(file, "has another data format of LMDB; open it with the program that wrote it");
  if (meta.free_pages.pad != head.page_size || meta.last_page > kMaxBytes / head.page_size)
    refuseDamaged(file, "its head is inconsistent");
  if ((meta.free_pages.flags & kOrderFlags) != MDB_INTEGERKEY || (meta.main.flags & kOrderFlags) != 0)
    refuseDamaged(file, "its head names another order of keys");
}

/// Of the other meta page LMDB reads the number of its commit alone. When the disk refuses the page of a new commit,
/// LMDB may leave one there that names roots of that commit.
void checkRoots(const Meta& meta, const MapFileHead& head, const std::filesystem::path& file) {
  for (const PageNumber root : {meta.main.root, meta.free_pages.root})
    if (root != kNoPage && (root > meta.last_page || (root + 1) * head.page_size > head.file_size))
      refuseDamaged(file, "it is cut short");
}

}  // namespace

void refuseFile(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::StoreUnavailable, file.string() + ": " + what);
}

void refuseDamaged(const std::filesystem::path& file, const std::string& what) {
  refuseFile(file, "the map is damaged: " + what + "; restore a copy, or remove the file and build it again");
}

void refuseIndex(const std::filesystem::path& file, Table index, const std::string& what) {
  refuseDamaged(file, std::string("index ") + kTableNames[static_cast<std::size_t>(index)] + " " + what);
}

const Meta* MapFileHead::metaOf(std::uint64_t wanted) const {
  for (const auto& meta : metas)
    if (meta && meta->transaction == wanted) return &*meta;
  return nullptr;
}

MapFileHead readMapFileHead(int descriptor, const std::filesystem::path& file) {
  MapFileHead head;
  head.metas = readConsecutiveMetas(descriptor);
  head.file_size = fileSize(descriptor, file);
  if (head.file_size == 0) return head;
  if (!head.metas[0] || !head.metas[1]) refuseFile(file, "is not a Cluxel map, or its head is damaged");
  const Meta &even = *head.metas[0], &odd = *head.metas[1];
  head.page_size = even.free_pages.pad;
  for (const auto& meta : head.metas) checkMeta(*meta, head, file);
  if (!areConsecutive(even, odd)) refuseDamaged(file, "its head names commits that do not follow each other");
  const Meta& newest = even.transaction >= odd.transaction ? even : odd;
  checkRoots(newest, head, file);
  head.last_page = newest.last_page;
  head.transaction = newest.transaction;
  return head;
}

bool hasNoCommit(const std::filesystem::path& file) {
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) return false;
  const std::array<std::optional<Meta>, 2> metas = readMetas(descriptor.get());
  return metas[0] && metas[1] && metas[0]->transaction == 0 && metas[1]->transaction == 0;
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
