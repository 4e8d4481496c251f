// SPDX-License-Identifier: Apache-2.0
// Copies a map under the lock that writers hold, or beside a writer whose commit does not come before the end of the
// copy.
#include "rdf/file/private_copy.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/lmdb_handles.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void failCopy(const fs::path& map, const fs::path& folder, int code) {
  throw Error(ErrorKind::StoreUnavailable,
              map.string() + ": its lock file cannot be written, and a private copy in " + folder.string() +
                  " failed (" + std::string(std::generic_category().message(code)) +
                  "); set TMPDIR to a folder with room, or ask for the right to write " + map.string() + "-lock");
}

/// A stretch of a file; `end` may lie behind the end of the file.
struct Stretch {
  off_t begin = 0, end = 0;
};

/// The next stretch from `at` on that is no hole; empty when only a hole follows. All that follows, where the file
/// system does not tell.
Stretch nextData(int file, off_t at) {
  const off_t begin = ::lseek(file, at, SEEK_DATA);
  if (begin < 0 && errno == ENXIO) return {at, at};
  const off_t end = begin < 0 ? -1 : ::lseek(file, begin, SEEK_HOLE);
  if (end > begin) return {begin, end};
  return {at, std::numeric_limits<off_t>::max()};
}

/// Copies a stretch, at most to the end of the file; errno value, or 0.
int copyStretch(int from, int to, const Stretch& stretch) {
  std::vector<char> buffer(std::size_t{1} << 20U);
  for (off_t at = stretch.begin; at < stretch.end;) {
    const auto room = std::min(static_cast<off_t>(buffer.size()), stretch.end - at);
    const ssize_t count = ::pread(from, buffer.data(), static_cast<std::size_t>(room), at);
    if (count == 0) return 0;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    for (ssize_t written = 0; written < count;) {
      const ssize_t part =
          ::pwrite(to, buffer.data() + written, static_cast<std::size_t>(count - written), at + written);
      if (part < 0 && errno != EINTR) return errno;
      written += part < 0 ? 0 : part;
    }
    at += count;
  }
  return 0;
}

/// Makes `copy` as long as the map, with its bytes alone. Holes stay holes, so that the temporary folder needs only the
/// room that the map takes on the disk.
int copyAnew(int map, int copy) {
  if (::ftruncate(copy, 0) != 0) return errno;
  for (Stretch data = nextData(map, 0); data.begin < data.end; data = nextData(map, data.end)) {
    if (const int code = copyStretch(map, copy, data); code != 0) return code;
    if (data.end == std::numeric_limits<off_t>::max()) break;
  }
  struct stat status {};
  return ::fstat(map, &status) == 0 && ::ftruncate(copy, status.st_size) == 0 ? 0 : errno;
}

/// Copies while another process may write; nothing when it has committed meanwhile. The pages of the newest commit
/// stay until the next one: LMDB writes to none of them, and only pages that the newest commit does not use become
/// holes. After the next commit they may be gone at once. So the commit is compared again at the end. A commit reaches
/// the meta pages last.
std::optional<int> copyBesideWriter(int map, int copy, const fs::path& file) {
  const std::uint64_t commit = readMapFileHead(map, file).transaction;
  if (const int code = copyAnew(map, copy); code != 0) return code;
  try {
    const bool has_same = readMapFileHead(copy, file).transaction == commit;
    if (has_same && readMapFileHead(map, file).transaction == commit) return 0;
  } catch (const Error&) {  // a meta page was copied while it was written
  }
  return std::nullopt;
}

/// Copies the last commit; errno value, or 0.
int copyCommit(int map, int copy, const fs::path& file) {
  constexpr int kAttempts = 5;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (tryLockAgainstWriters(map, WriteLock::Copying, file)) break;
    if (const auto code = copyBesideWriter(map, copy, file)) return *code;
  }
  lockAgainstWriters(map, WriteLock::Copying, file);
  const int code = copyAnew(map, copy);
  ::flock(map, LOCK_UN);
  return code;
}

}  // namespace

PrivateCopy::PrivateCopy(const fs::path& map, int descriptor) {
  if (folder_.path().empty()) failCopy(map, temporaryFolderPath(), errno);
  file_ = folder_.path() / "copy.clx";
  copy_ = Descriptor(::open(file_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  int code = copy_.get() < 0 ? errno : 0;
  if (code == 0) code = copyCommit(descriptor, copy_.get(), map);
  if (code != 0) failCopy(map, folder_.path(), code);
}

}  // namespace cluxel::rdf
