// SPDX-License-Identifier: Apache-2.0
// Copies a map under the lock that writers hold, or beside a writer whose commit does not come before the end of the
// copy.
#include "rdf/file/private_copy.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
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

/// Copies all bytes; errno value, or 0.
int copyBytes(int from, int to) {
  std::vector<char> buffer(std::size_t{1} << 20U);
  for (off_t at = 0;;) {
    const ssize_t count = ::pread(from, buffer.data(), buffer.size(), at);
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
}

/// Makes `copy` hold the bytes of the map alone.
int copyAnew(int map, int copy) {
  if (::ftruncate(copy, 0) != 0) return errno;
  return copyBytes(map, copy);
}

/// Copies while another process may write; nothing when it has committed meanwhile. LMDB writes no page that belongs to
/// the newest commit or to the one before, so that the pages of a commit stay until another two have followed. A commit
/// reaches the meta pages last.
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
