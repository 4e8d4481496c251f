// SPDX-License-Identifier: Apache-2.0
// Finds out whether the lock file beside a map is its own, and makes another one where it is not.
#include "rdf/file/opening/lmdb_opening.hpp"

#include <unistd.h>

#include <cerrno>
#include <utility>

#include "rdf/file/file_guards.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/file/opening/descriptor_names.hpp"
#include "rdf/file/opening/newest_commit.hpp"
#include "rdf/file/table.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

constexpr unsigned kMaxReaders = 510;
constexpr std::size_t kSmallestMap = std::size_t{1} << 28U;
#if defined(__has_feature)
#define CLUXEL_THREAD_SANITIZER __has_feature(thread_sanitizer)
#elif defined(__SANITIZE_THREAD__)
#define CLUXEL_THREAD_SANITIZER 1
#else
#define CLUXEL_THREAD_SANITIZER 0
#endif
#if CLUXEL_THREAD_SANITIZER
constexpr std::size_t kMaxMapBytes = std::size_t{1} << 34U;  // ThreadSanitizer reserves most of the address space
#else
constexpr std::size_t kMaxMapBytes = std::size_t{1} << 40U;
#endif

OpenedLmdb withOutcome(LmdbOutcome outcome) {
  OpenedLmdb opened;
  opened.outcome = outcome;
  return opened;
}

/// A lock file has a wrong number when it is another map's, or when the map was changed with another lock file.
bool hasRightNumber(const LmdbRequest& request, const OpenedLmdb& opened) {
  MDB_txn* raw = nullptr;
  checkLmdb(mdb_txn_begin(opened.handle.get(), nullptr, MDB_RDONLY, &raw), request.file, "read the map");
  const TxnHandle reading(raw);
  if (mdb_txn_id(raw) == newestCommit(opened.handle.get())) return true;
  return reachesNewest(raw, request.file, *opened.use,
                       [&](const auto& work) { return runWithoutWriters(request.descriptor, request.file, work); });
}

/// Whether a process writes the map with another lock file: the number in the own one will then be wrong.
bool isWrittenElsewhere(const LmdbRequest& request, const JointUse& use) {
  return use.hasOtherLockFiles() && !runWithoutWriters(request.descriptor, request.file, [] {});
}

bool isOpen(MDB_env* handle, const LmdbRequest& request) {
  int descriptor = -1;
  checkLmdb(mdb_env_get_fd(handle, &descriptor), request.file, "open the map");
  return identityOf(descriptor, request.file) == identityOf(request.descriptor, request.file);
}

OpenedLmdb openWithoutLockFile(const LmdbRequest& request, const LockFile& lock) {
  if (request.mode != OpenMode::ReadOnly) failLockFile(request.file, lock);
  if (lock.state == LockFileState::Refused) return withOutcome(LmdbOutcome::NeedsCopy);
  lockAgainstWriters(request.descriptor, WriteLock::Copying, request.file);
  OpenedLmdb opened;
  opened.can_write = false;
  opened.holds_writers = true;
  const fs::path name = nameOfDescriptor(request.descriptor);
  const bool has_name = isNamed(identityOf(request.descriptor, request.file), name);
  opened.handle = openLmdb(has_name ? name : request.file, request.file, request.file_size, MDB_RDONLY | MDB_NOLOCK);
  if (!isOpen(opened.handle.get(), request)) return withOutcome(LmdbOutcome::Renamed);
  return opened;
}

/// LMDB locks the lock file while it opens it, and another process would wait for that without end. So they come to it
/// one after the other. None: another process is there.
EnvHandle openBesideOthers(const LmdbRequest& request, const JointUse& use) {
  const DescriptorNames names(request.descriptor, use.lockFile());  // the temporary folder may be slow
  const auto turn = NameLock::withoutWaiting(use.lockFile());
  if (!turn) return nullptr;
  return openLmdb(names.map().empty() ? request.file : names.map(), request.file, request.file_size,
                  request.can_write ? request.flags : MDB_RDONLY);
}

OpenedLmdb openWithLockFile(const LmdbRequest& request) {
  LockFile lock = prepareLockFile(request.file, request.descriptor, request.can_write);
  if (lock.state != LockFileState::Usable) return openWithoutLockFile(request, lock);
  OpenedLmdb opened;
  opened.can_write = request.can_write;
  opened.use = std::make_unique<JointUse>(request.descriptor, std::move(lock.descriptor));
  if (opened.use->isLockFileOfOthers()) return withOutcome(LmdbOutcome::ForeignLockFile);
  if (request.mode == OpenMode::ReadOnly && isWrittenElsewhere(request, *opened.use))
    return withOutcome(LmdbOutcome::NeedsCopy);
  opened.handle = openBesideOthers(request, *opened.use);
  if (!opened.handle) return withOutcome(LmdbOutcome::Taken);
  const bool is_named = isNamed(identityOf(request.descriptor, request.file), request.file);
  if (!is_named || !isOpen(opened.handle.get(), request)) return withOutcome(LmdbOutcome::Renamed);
  if (!hasRightNumber(request, opened)) return withOutcome(LmdbOutcome::OutdatedLockFile);
  return opened;
}

bool hasOwnLockFile(const OpenedLmdb& opened) {
  return opened.outcome != LmdbOutcome::ForeignLockFile && opened.outcome != LmdbOutcome::OutdatedLockFile;
}

/// False when another process has this map, too, open with it, or the folder may not be changed.
bool setLockFileAside(const LmdbRequest& request) {
  LockFile lock = prepareLockFile(request.file, request.descriptor, request.can_write);
  if (lock.state != LockFileState::Usable) return false;
  const JointUse use(request.descriptor, std::move(lock.descriptor));
  return !use.hasCompany() && (::unlink(lockFileOf(request.file).c_str()) == 0 || errno == ENOENT);
}

[[noreturn]] void failOtherLockFile(const LmdbRequest& request, LmdbOutcome outcome) {
  if (outcome == LmdbOutcome::OutdatedLockFile) throw LockFileOutdated(request.file);
  throw Error(ErrorKind::StoreUnavailable,
              request.file.string() + ": its lock file " + lockFileOf(request.file).string() +
                  " is in use for another file that had this name; end the processes that have either open, and run "
                  "again");
}

OpenedLmdb openByNameOnce(const LmdbRequest& request) {
  const FileIdentity identity = identityOf(request.descriptor, request.file);
  OpenedLmdb opened;
  {
    const NameLock lock(request.descriptor, NameLock::Kind::Opening, request.file);
    if (!isNamed(identity, request.file)) return withOutcome(LmdbOutcome::Renamed);
    opened = openWithLockFile(request);
    if (hasOwnLockFile(opened)) return opened;
  }
  if (request.can_write) {
    const NameLock lock(request.descriptor, NameLock::Kind::Replacing, request.file);
    if (!isNamed(identity, request.file)) return withOutcome(LmdbOutcome::Renamed);
    opened = openWithLockFile(request);
    if (hasOwnLockFile(opened)) return opened;  // another process was faster
    if (setLockFileAside(request)) opened = openWithLockFile(request);
    if (hasOwnLockFile(opened)) return opened;
  }
  if (request.mode != OpenMode::ReadOnly) failOtherLockFile(request, opened.outcome);
  return withOutcome(LmdbOutcome::NeedsCopy);
}

}  // namespace

EnvHandle openLmdb(const fs::path& name, const fs::path& file, std::uint64_t file_size, unsigned flags) {
  int code = 0;
  for (std::size_t map_size = kMaxMapBytes; map_size >= kSmallestMap && map_size > file_size; map_size /= 2) {
    MDB_env* raw = nullptr;
    checkLmdb(mdb_env_create(&raw), file, "open the map");
    EnvHandle handle(raw);
    mdb_env_set_maxreaders(raw, kMaxReaders);
    mdb_env_set_maxdbs(raw, kTableCount);
    mdb_env_set_mapsize(raw, map_size);
    code = mdb_env_open(raw, name.c_str(), flags | MDB_NOSUBDIR | MDB_NOTLS, 0666);
    if (code == MDB_SUCCESS) return handle;
    if (code != ENOMEM && code != EINVAL) break;  // EINVAL: Valgrind's limit
  }
  failStore(file, code, "open the map");
}

/// The name is free while it waits, so that others can replace the map.
OpenedLmdb openLmdbByName(const LmdbRequest& request) {
  const NamePatience patience(request.file);
  while (true) {
    OpenedLmdb opened = openByNameOnce(request);
    if (opened.outcome != LmdbOutcome::Taken) return opened;
    patience.wait();
  }
}

}  // namespace cluxel::rdf
