// SPDX-License-Identifier: Apache-2.0
// flock on a file that its holder removes: after locking, check that the path still names the locked file.
#include "mapping/build/build_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

fs::path buildLockOf(fs::path map) {
  return map += ".build-lock";
}

[[noreturn]] void refuse(const fs::path& map, const std::string& what) {
  throw Error(ErrorKind::StoreUnavailable, map.string() + ": " + what);
}

std::string holderOf(int descriptor) {
  char text[32] = {};
  const ssize_t size = ::pread(descriptor, text, sizeof text - 1, 0);
  return size > 0 ? "process " + std::string(text, static_cast<std::size_t>(size)) : "another process";
}

bool isNamed(int descriptor, const fs::path& file) {
  struct stat mine {
  }, there{};
  return ::fstat(descriptor, &mine) == 0 && ::stat(file.c_str(), &there) == 0 && mine.st_dev == there.st_dev &&
         mine.st_ino == there.st_ino;
}

bool isForbidden(const fs::path& path) {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0 &&
         (errno == EACCES || errno == EPERM || errno == EROFS);
}

}  // namespace

bool hasBuildLock(const fs::path& map) {
  std::error_code error;
  return fs::exists(buildLockOf(map), error);
}

bool mayWriteMap(const fs::path& map) {
  return !isForbidden(fs::absolute(map).parent_path()) && !isForbidden(map) && !isForbidden(rdf::lockFileOf(map)) &&
         !isForbidden(buildLockOf(map));
}

BuildLock::BuildLock(const fs::path& map) : file_(buildLockOf(map)) {
  while (true) {
    const int descriptor = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (std::error_code ignored; descriptor < 0 && errno == ELOOP && fs::is_symlink(file_, ignored))
      refuse(map, "its lock " + file_.string() +
                      " is a symbolic link, and what it leads to would be overwritten; remove the link");
    if (descriptor < 0) refuse(map, std::string("no lock can be made beside it: ") + std::strerror(errno));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const std::string holder = holderOf(descriptor);
      ::close(descriptor);
      throw rdf::MapBusy(map, holder + " is changing it; wait until that has ended");
    }
    if (isNamed(descriptor, file_)) {
      descriptor_ = descriptor;
      break;
    }
    ::close(descriptor);  // it was removed by a process that has just ended
  }
  const std::string id = std::to_string(::getpid());
  if (::ftruncate(descriptor_, 0) == 0) (void)!::pwrite(descriptor_, id.data(), id.size(), 0);
}

BuildLock::~BuildLock() {
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

}  // namespace cluxel::mapping
