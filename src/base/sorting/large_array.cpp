// SPDX-License-Identifier: Apache-2.0
// Room on the disk is reserved first: a write to a page without room would end the process.
#include "base/sorting/large_array.hpp"

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <new>

#include "base/file_bytes.hpp"
#include "base/sorting/nameless_file.hpp"
#include "base/sorting/temporary_bytes.hpp"

namespace cluxel {

namespace {

/// A file system that copies pages when they are written would need more room than was reserved. Where it can be told
/// not to, this must be before the first byte; others know no such flag.
void writeInPlace(int file) {
  int flags = 0;
  if (::ioctl(file, FS_IOC_GETFLAGS, &flags) != 0) return;
  flags |= FS_NOCOW_FL;
  ::ioctl(file, FS_IOC_SETFLAGS, &flags);
}

/// Returns 0, or what went wrong.
int reserve(int file, std::size_t bytes) {
  int code = EINTR;
  while (code == EINTR) code = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  return code;
}

/// Returns 0, or what went wrong. Some file systems tell only then that there is no room.
int closed(int file) {
  return ::close(file) == 0 || errno == EINTR ? 0 : errno;
}

}  // namespace

void* mapTemporaryFile(std::size_t bytes) {
  if (bytes > static_cast<std::size_t>(std::numeric_limits<off_t>::max())) throw std::bad_alloc();
  requireFileSize("enlarged", bytes);
  const int file = openNamelessFile(temporaryFolderPath());
  if (file < 0) failTemporaryFile("made", errno);
  writeInPlace(file);
  if (const int code = reserve(file, bytes); code != 0) ::close(file), failTemporaryFile("enlarged", code);
  void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  const int mapped = memory == MAP_FAILED ? errno : 0, code = closed(file);  // the mapping keeps the file
  if (mapped == ENOMEM) throw std::bad_alloc();
  if (mapped != 0) failTemporaryFile("mapped", mapped);
  if (code != 0) ::munmap(memory, bytes), failTemporaryFile("enlarged", code);
  return memory;
}

void unmapTemporaryFile(void* memory, std::size_t bytes) noexcept {
  ::munmap(memory, bytes);
}

}  // namespace cluxel
