// SPDX-License-Identifier: Apache-2.0
// Counts what a rewrite would free, and rewrites the map beside itself, or gives free pages back to the file system.
#include "mapping/change/map_compaction.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/build_lock.hpp"
#include "mapping/build/early_commit.hpp"
#include "mapping/build/work_file.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/file/space/free_pages.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kSmallestGain = std::uint64_t{1} << 20U;
/// A change of a small map leaves half-filled pages in most of an index. Up to this size filling all takes a third of a
/// second at most.
constexpr std::uint64_t kSmallMap = std::uint64_t{96} << 20U;

bool isMuch(std::uint64_t bytes, std::uint64_t of_bytes, double max_share) {
  return bytes > kSmallestGain && static_cast<double>(bytes) > max_share * static_cast<double>(of_bytes);
}

struct stat statusOf(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0)
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": " + std::strerror(errno));
  return status;
}

std::uint64_t sizeOf(const fs::path& file) {
  return static_cast<std::uint64_t>(statusOf(file).st_size);
}

/// The names would lead to different maps after that.
void refuseOtherNames(const fs::path& map) {
  if (statusOf(map).st_nlink > 1)
    throw Error(ErrorKind::StoreUnavailable, map.string() +
                                                 ": has another name (a hard link), which would keep the old file; "
                                                 "remove the other name, or write the compacted map to another file");
}

/// Whether a small map, of which no other name (a hard link) would keep the old file, has many half-filled pages of
/// indexes.
bool isToBeFilled(const fs::path& map, const rdf::FreeSpace& space) {
  return space.file_bytes <= kSmallMap &&
         isMuch(space.bytes - space.in_free_pages, space.file_bytes - space.in_free_pages, kMaxFreeShare) &&
         statusOf(map).st_nlink == 1;
}

/// The copy goes to the owner and the group of the map, which would otherwise lose it to whoever compacts it.
void keepOwner(const fs::path& copy, const fs::path& map) {
  const struct stat own = statusOf(copy), old = statusOf(map);
  if (own.st_uid == old.st_uid && own.st_gid == old.st_gid) return;
  if (::chown(copy.c_str(), old.st_uid, old.st_gid) != 0)
    throw Error(ErrorKind::StoreUnavailable,
                map.string() + ": belongs to another user or group, who would lose it; let its owner compact it");
}

void removeCopy(const fs::path& copy) {
  std::error_code ignored;
  fs::remove(copy, ignored);
  fs::remove(rdf::lockFileOf(copy), ignored);
}

fs::path copyOf(const fs::path& map) {
  return withoutLinks(map).string() + ".compact";
}

void noteFailure(const fs::path& map, const std::exception& error, ProgressSink& sink) {
  const std::string name = map.string() + ": ", why = error.what();
  sink.note(name + "the map is sound, but its free space stays in the file: " +
            (why.starts_with(name) ? why.substr(name.size()) : why));
}

std::optional<rdf::FreeSpace> knownSpaceOf(const fs::path& map, ProgressSink& sink) {
  try {
    return rdf::freeSpaceOf(rdf::Environment::open(map, rdf::OpenMode::ReadOnly)->read());
  } catch (const std::exception& error) {
    noteFailure(map, error, sink);
    return std::nullopt;
  }
}

}  // namespace

/// Locks out other writers: what they commit while the file is replaced would be lost. Counts the bytes while it holds
/// the map: it may be moved away as soon as it is replaced.
CompactedBytes compactMap(const fs::path& map, rdf::CopiedPages pages) {
  const fs::path file = withoutLinks(map), copy = copyOf(map);
  const BuildLock no_build(file);
  refuseOtherNames(map);
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadWrite);
  if (hasEarlyCommit(environment->read())) {  // of a killed command
    refuseUncommittedBuild(environment->read(), map);
    rdf::WriteTransaction transaction = environment->write();
    eraseEarlyCommit(transaction);
    transaction.commit();
  }
  const rdf::WriteTransaction no_other_writer = environment->write();
  removeCopy(copy);  // left by a killed run
  try {
    environment->compactTo(copy, pages);
    keepOwner(copy, file);
    const CompactedBytes bytes{sizeOf(file), sizeOf(copy)};
    rdf::replaceMapFile(copy, file);
    return bytes;
  } catch (...) {
    removeCopy(copy);
    throw;
  }
}

CompactedBytes copyCompacted(const fs::path& map, const fs::path& copy) {
  const auto environment = rdf::Environment::open(map, rdf::OpenMode::ReadOnly);
  const std::uint64_t before = sizeOf(map);
  refuseUncommittedBuild(environment->read(), map);
  environment->compactTo(copy);
  const bool has_rest = hasEarlyCommit(rdf::Environment::open(copy, rdf::OpenMode::ReadOnly)->read());
  if (has_rest) compactMap(copy);
  std::error_code ignored;
  fs::remove(rdf::lockFileOf(copy), ignored);  // nobody else knows of the copy yet
  return {before, sizeOf(copy)};
}

void compactIfSparse(const fs::path& map, ProgressSink& sink, double max_free_share) {
  if (const auto space = knownSpaceOf(map, sink)) compactIfSparse(map, *space, sink, max_free_share);
}

Compaction compactIfSparse(const fs::path& map, const rdf::FreeSpace& space, ProgressSink& sink,
                           double max_free_share) {
  try {
    if (!fs::exists(copyOf(map)) && !isMuch(space.bytes, space.file_bytes, max_free_share) && !isToBeFilled(map, space))
      return Compaction::NotNeeded;
    if (fs::space(fs::absolute(withoutLinks(map)).parent_path()).available < fs::file_size(map))
      throw Error(ErrorKind::StoreUnavailable, "there is no room beside it for a copy");
    const bool pages_are_full = !isMuch(space.bytes - space.in_free_pages, space.file_bytes, max_free_share);
    const bool fills_pages = !pages_are_full || space.file_bytes <= kSmallMap;
    compactMap(map, fills_pages ? rdf::CopiedPages::Filled : rdf::CopiedPages::AsTheyAre);
    return Compaction::Done;
  } catch (const std::exception& error) {
    noteFailure(map, error, sink);
    return Compaction::Failed;
  }
}

void freeSpaceOfChange(const fs::path& map, const rdf::FreeSpace& space, ProgressSink& sink) {
  if (compactIfSparse(map, space, sink, kMaxFreeShareOfChanged) == Compaction::Done) return;
  try {
    if (isMuch(space.freeOnDisk(), space.disk_bytes, kMaxFreeShareOfDisk))
      rdf::releaseFreePages(*rdf::Environment::open(map, rdf::OpenMode::ReadWrite));
  } catch (const std::exception& error) {
    noteFailure(map, error, sink);
  }
}

void freeSpaceOfChange(const fs::path& map, ProgressSink& sink) {
  if (const auto space = knownSpaceOf(map, sink)) freeSpaceOfChange(map, *space, sink);
}

void finishCompaction(const fs::path& map, ProgressSink& sink) {
  std::error_code ignored;
  if (!fs::exists(copyOf(map), ignored)) return;
  try {
    const BuildLock nobody_compacts(withoutLinks(map));
    removeCopy(copyOf(map));
  } catch (const Error&) {
    return;  // it is not left, but being made
  }
  freeSpaceOfChange(map, sink);
}

}  // namespace cluxel::mapping
