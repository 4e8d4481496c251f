// SPDX-License-Identifier: Apache-2.0
// Room on the disk is reserved first: a write to a page without room would end the process.
#include "base/sorting/large_array.hpp"

#include <fcntl.h>
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

/// Returns 0, or what went wrong.
int reserve(int file, std::size_t bytes) {
  int code = EINTR;
  while (code == EINTR) code = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  return code;
}

}  // namespace

void* mapTemporaryFile(std::size_t bytes) {
  if (bytes > static_cast<std::size_t>(std::numeric_limits<off_t>::max())) throw std::bad_alloc();
  const int file = openNamelessFile(temporaryFolderPath());
  if (file < 0) failTemporaryFile("made", errno);
  const int code = reserve(file, bytes);
  void* const memory = code != 0 ? MAP_FAILED : ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);  // the mapping keeps the file
  if (code != 0) failTemporaryFile("enlarged", code);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return memory;
}

void unmapTemporaryFile(void* memory, std::size_t bytes) noexcept {
  ::munmap(memory, bytes);
}

}  // namespace cluxel
