// SPDX-License-Identifier: Apache-2.0
// pread and pwrite, which may be interrupted and may take a part only.
#include "base/sorting/temporary_bytes.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "base/file_bytes.hpp"
#include "base/sorting/nameless_file.hpp"
#include "cluxel/error.hpp"

namespace cluxel {

namespace {

std::string helpFor(int code) {
  if (code == ENOSPC || code == EDQUOT) return "make room there, or set TMPDIR to a folder with more";
  if (code == EFBIG) return "allow larger files (ulimit -f), or set TMPDIR to a folder that can hold them";
  return "set TMPDIR to a folder that can be written";
}

}  // namespace

void failTemporaryFile(const std::string& what, int code) {
  throw Error(ErrorKind::StoreUnavailable, temporaryFolderPath().string() + ": a temporary file cannot be " + what +
                                               " (" + std::generic_category().message(code) + "); " + helpFor(code));
}

void requireFileSize(const std::string& what, std::uint64_t bytes) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && bytes > limit.rlim_cur)
    failTemporaryFile(what, EFBIG);
}

TemporaryBytes::~TemporaryBytes() {
  if (file_ >= 0) ::close(file_);
}

std::uint64_t TemporaryBytes::append(std::string_view bytes) {
  if (file_ < 0) file_ = openNamelessFile(temporaryFolderPath());
  if (file_ < 0) failTemporaryFile("made", errno);
  const std::uint64_t begin = size_;
  requireFileSize("written", begin + bytes.size());
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failTemporaryFile("written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
    size_ += static_cast<std::uint64_t>(count);
  }
  return begin;
}

void TemporaryBytes::read(std::uint64_t place, char* into, std::size_t count) const {
  while (count > 0) {
    const ssize_t part = ::pread(file_, into, count, static_cast<off_t>(place));
    if (part < 0 && errno == EINTR) continue;
    if (part <= 0) failTemporaryFile("read", part < 0 ? errno : EIO);
    into += part, place += static_cast<std::uint64_t>(part), count -= static_cast<std::size_t>(part);
  }
}

void TemporaryBytes::clear() {
  size_ = 0;
  if (file_ >= 0 && ::ftruncate(file_, 0) != 0) failTemporaryFile("emptied", errno);
}

}  // namespace cluxel
