// SPDX-License-Identifier: Apache-2.0
// File descriptors, file locks and preallocation.
#include "rdf/store/file_guards.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "rdf/store/lmdb_handles.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

/// More than LMDB needs for kMaxReaders readers of 64 bytes each.
constexpr off_t kLockFileBytes = 64 * 1024;
/// A byte offset that is locked but never written; LMDB itself takes no lock on the map file.
constexpr off_t kNameByte = off_t{1} << 61;

void lockNameByte(int descriptor, short kind) {
  struct flock range {};
  range.l_type = kind;
  range.l_whence = SEEK_SET;
  range.l_start = kNameByte;
  range.l_len = 1;
  while (::fcntl(descriptor, F_OFD_SETLKW, &range) != 0 && errno == EINTR) {
  }
}

}  // namespace

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

NameLock::NameLock(int descriptor, Kind kind) : descriptor_(descriptor) {
  lockNameByte(descriptor_, kind == Kind::Opening ? F_RDLCK : F_WRLCK);
}

NameLock::~NameLock() {
  lockNameByte(descriptor_, F_UNLCK);
}

fs::path lockFileOf(fs::path map) {
  return map += "-lock";
}

int reserveLockFile(const fs::path& map) {
  const int descriptor = ::open(lockFileOf(map).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) return errno;
  const int code = ::fallocate(descriptor, 0, 0, kLockFileBytes) == 0 ? 0 : errno;
  ::close(descriptor);
  return code == EOPNOTSUPP || code == ENOSYS ? 0 : code;
}

}  // namespace cluxel::rdf
