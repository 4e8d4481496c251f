// SPDX-License-Identifier: Apache-2.0
// File descriptors and file locks.
#include "rdf/file/file_guards.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

constexpr auto kLockPatience = std::chrono::milliseconds(1500);
constexpr auto kLockPause = std::chrono::milliseconds(10);
/// Longer than the 3 s for which who finds the number of a lock file wrong may keep the name (see openLmdbByName()).
constexpr auto kNamePatience = std::chrono::seconds(5);
/// Short, so that who replaces a map comes to it between many who open it.
constexpr auto kNamePause = std::chrono::milliseconds(2);
/// A byte offset that is locked but never written; LMDB itself takes no lock on the map file.
constexpr off_t kNameByte = off_t{1} << 61;

/// False when another process has the byte. True also where the file system has no such locks.
bool tryLockNameByte(int descriptor, short kind) {
  struct flock range {};
  range.l_type = kind;
  range.l_whence = SEEK_SET;
  range.l_start = kNameByte;
  range.l_len = 1;
  int code = 0;
  do code = ::fcntl(descriptor, F_OFD_SETLK, &range);
  while (code != 0 && errno == EINTR);
  return code == 0 || (errno != EAGAIN && errno != EACCES);
}

}  // namespace

TemporaryFolder::TemporaryFolder() : TemporaryFolder(temporaryFolderPath()) {}

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  std::string name = (parent / "cluxel-XXXXXX").string();
  if (::mkdtemp(name.data()) != nullptr) path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

FileIdentity identityOf(int descriptor, const fs::path& file) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) failStore(file, errno, "examine the file");
  return {status.st_dev, status.st_ino};
}

bool isNamed(const FileIdentity& identity, const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 && FileIdentity{status.st_dev, status.st_ino} == identity;
}

LowDescriptors::LowDescriptors() {
  for (int& taken : taken_) {
    taken = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (taken <= STDERR_FILENO) continue;
    ::close(taken);
    taken = -1;
    return;
  }
}

LowDescriptors::~LowDescriptors() {
  for (const int taken : taken_)
    if (taken >= 0) ::close(taken);
}

NameLock::NameLock(int descriptor, Kind kind, const fs::path& map) : descriptor_(descriptor) {
  NamePatience patience(map);
  while (!tryLockNameByte(descriptor_, kind == Kind::Opening ? F_RDLCK : F_WRLCK)) patience.wait();
}

std::unique_ptr<NameLock> NameLock::withoutWaiting(int descriptor) {
  if (!tryLockNameByte(descriptor, F_WRLCK)) return nullptr;
  return std::unique_ptr<NameLock>(new NameLock(descriptor));
}

NamePatience::NamePatience(const fs::path& map) : map_(map), end_(std::chrono::steady_clock::now() + kNamePatience) {}

void NamePatience::wait() const {
  if (std::chrono::steady_clock::now() > end_)
    throw MapBusy(map_,
                  "one or more processes have been opening or replacing the map for more than 5 s; when one is "
                  "stopped, let it go on, or end it; then run again");
  std::this_thread::sleep_for(kNamePause);
}

NameLock::~NameLock() {
  tryLockNameByte(descriptor_, F_UNLCK);
}

bool tryLockAgainstWriters(int descriptor, WriteLock kind, const fs::path& file) {
  const int operation = kind == WriteLock::Writing ? LOCK_EX : LOCK_SH;
  if (::flock(descriptor, operation | LOCK_NB) == 0) return true;
  if (errno != EWOULDBLOCK && errno != EINTR) failStore(file, errno, "lock the map");
  return false;
}

void lockAgainstWriters(int descriptor, WriteLock kind, const fs::path& file) {
  const auto deadline = std::chrono::steady_clock::now() + kLockPatience;
  while (!tryLockAgainstWriters(descriptor, kind, file)) {
    if (std::chrono::steady_clock::now() > deadline) throw MapBusy(file);
    std::this_thread::sleep_for(kLockPause);
  }
}

bool runWithoutWriters(int descriptor, const fs::path& file, const std::function<void()>& work) {
  // NFS gives the lock of a writer only to who may write the file.
  const bool can_write = (::fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
  if (!tryLockAgainstWriters(descriptor, can_write ? WriteLock::Writing : WriteLock::Copying, file)) return false;
  try {
    work();
  } catch (...) {
    ::flock(descriptor, LOCK_UN);
    throw;
  }
  ::flock(descriptor, LOCK_UN);
  return true;
}

void refusePipe(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": is a pipe or a device, a map was expected");
}

}  // namespace cluxel::rdf
