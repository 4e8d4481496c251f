// SPDX-License-Identifier: Apache-2.0
// Makes lock files with the rights of their maps.
#include "rdf/file/lock_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "cluxel/error.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/lmdb_handles.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

/// More than LMDB needs for kMaxReaders readers of 64 bytes each.
constexpr off_t kLockFileBytes = 64 * 1024;

bool isFullDisk(int code) {
  return code == ENOSPC || code == EDQUOT || code == EFBIG;
}

LockFile unusable(int code) {
  return {isFullDisk(code) ? LockFileState::NoRoom : LockFileState::Refused, code, Descriptor()};
}

/// The owner stays as it is where the process may not change it.
void adoptRights(int lock, int map) {
  struct stat rights {};
  if (::fstat(map, &rights) != 0) return;
  (void)!::fchown(lock, rights.st_uid, static_cast<gid_t>(-1));
  (void)!::fchown(lock, static_cast<uid_t>(-1), rights.st_gid);
  (void)!::fchmod(lock, rights.st_mode & 0666U);
}

/// `is_new`: the file was made by this call.
Descriptor openLockFile(const fs::path& lock, bool can_make, bool& is_new) {
  is_new = false;
  Descriptor there(::open(lock.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC));
  if (there.get() >= 0 || errno != ENOENT || !can_make) return there;
  Descriptor made(::open(lock.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  is_new = made.get() >= 0;
  if (is_new || errno != EEXIST) return made;
  return Descriptor(::open(lock.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC));  // another process was faster
}

}  // namespace

fs::path lockFileOf(fs::path map) {
  return map += "-lock";
}

LockFile prepareLockFile(const fs::path& map, int descriptor, bool can_write) {
  bool is_new = false;
  Descriptor lock = openLockFile(lockFileOf(map), can_write, is_new);
  if (lock.get() < 0) return unusable(errno);
  if (is_new) adoptRights(lock.get(), descriptor);
  const int code = ::fallocate(lock.get(), 0, 0, kLockFileBytes) == 0 ? 0 : errno;
  if (code != 0 && code != EOPNOTSUPP && code != ENOSYS) return unusable(code);
  return {LockFileState::Usable, 0, std::move(lock)};
}

void failLockFile(const fs::path& map, const LockFile& lock) {
  const fs::path file = lockFileOf(map);
  if (std::error_code ignored; lock.reason == ELOOP && fs::is_symlink(file, ignored))
    throw Error(ErrorKind::StoreUnavailable,
                map.string() + ": its lock file " + file.string() +
                    " is a symbolic link, and what it leads to would be overwritten; remove the link");
  struct stat status {};
  if (lock.state == LockFileState::NoRoom || ::stat(file.c_str(), &status) != 0)
    failStore(map, lock.reason, "make its lock file");
  throw Error(ErrorKind::StoreUnavailable,
              map.string() + ": its lock file " + file.string() + " cannot be written (" + std::strerror(lock.reason) +
                  "); it belongs to user " + std::to_string(status.st_uid) +
                  ": remove it when no process has the map open, or change its rights to those of the map");
}

}  // namespace cluxel::rdf
