// SPDX-License-Identifier: Apache-2.0
// Copies a map under the lock that writers hold.
#include "rdf/file/private_copy.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
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

}  // namespace

PrivateCopy::PrivateCopy(const fs::path& map, int descriptor) {
  if (folder_.path().empty()) failCopy(map, temporaryFolderPath(), errno);
  file_ = folder_.path() / "copy.clx";
  copy_ = Descriptor(::open(file_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  int code = copy_.get() < 0 ? errno : 0;
  if (code == 0) {
    lockAgainstWriters(descriptor, WriteLock::Copying, map);
    code = copyBytes(descriptor, copy_.get());
    ::flock(descriptor, LOCK_UN);
  }
  if (code != 0) failCopy(map, folder_.path(), code);
}

}  // namespace cluxel::rdf
