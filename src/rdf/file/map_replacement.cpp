// SPDX-License-Identifier: Apache-2.0
// Replaces a map by renaming, while other processes have it open.
#include "rdf/file/map_replacement.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <thread>

#include "base/file_bytes.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/lock_file.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::milliseconds kOutdatedPatience{1500}, kOutdatedPause{10};

/// Prevents others from opening the map, if it exists, during the rename.
class HeldName {
 public:
  explicit HeldName(const fs::path& map) : descriptor_(::open(map.c_str(), O_RDWR | O_CLOEXEC)) {
    if (descriptor_ >= 0) lock_.emplace(descriptor_, NameLock::Kind::Replacing, map);
  }
  HeldName(const HeldName&) = delete;
  HeldName& operator=(const HeldName&) = delete;
  ~HeldName() {
    lock_.reset();
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  /// The file's permissions.
  std::optional<mode_t> mode() const {
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) return std::nullopt;
    return status.st_mode & 07777U;
  }

 private:
  int descriptor_;
  std::optional<NameLock> lock_;
};

/// Others wait in the meantime.
void exchange(const fs::path& fresh, const fs::path& map) {
  const HeldName old_name(map), fresh_name(fresh);
  const fs::path lock = lockFileOf(map), old_lock = lock.string() + ".replaced";
  // A lock file stores the transaction id of its map, so the new map must never be opened with the old lock file.
  std::rename(lock.c_str(), old_lock.c_str());
  if (old_name.mode()) (void)!::chmod(fresh.c_str(), *old_name.mode());
  if (std::rename(fresh.c_str(), map.c_str()) != 0) {
    const int reason = errno;
    std::rename(old_lock.c_str(), lock.c_str());
    throw Error(ErrorKind::StoreUnavailable,
                fresh.string() + ": is whole, but cannot be moved to " + map.string() + ": " + std::strerror(reason));
  }
  std::rename(lockFileOf(fresh).c_str(), lock.c_str());  // readers of the new map are registered in its lock file
  ::unlink(old_lock.c_str());
}

}  // namespace

MapBusy::MapBusy(const fs::path& map)
    : MapBusy(map, "another process is writing to the map or copying it; wait until it has ended and run again") {}

MapBusy::MapBusy(const fs::path& map, const std::string& what)
    : Error(ErrorKind::StoreUnavailable, map.string() + ": " + what) {}

MapReplaced::MapReplaced(const fs::path& map)
    : Error(ErrorKind::StoreUnavailable, map.string() +
                                             ": was replaced or removed since it was opened (compacted, or "
                                             "replaced by a build); nothing was written: run again") {}

LockFileOutdated::LockFileOutdated(const fs::path& map)
    : Error(ErrorKind::StoreUnavailable,
            map.string() + ": its lock file " + lockFileOf(map).string() +
                " is out of date: the map was changed under another name (it was moved, or has a hard link), or a "
                "writer was killed at the end of its commit; end the processes that have the map open, and run again") {
}

WriteTransaction writeMap(const fs::path& map, std::chrono::milliseconds patience) {
  const auto begin = std::chrono::steady_clock::now();
  constexpr int kMaxReplacements = 100;
  for (int replacements = 0;;) {
    const auto waited = [&begin] { return std::chrono::steady_clock::now() - begin; };
    try {
      return Environment::open(map, OpenMode::ReadWrite)->write();
    } catch (const MapReplaced&) {
      if (++replacements == kMaxReplacements) throw;
    } catch (const LockFileOutdated&) {  // the map is closed now; others may have to close it, too
      if (waited() >= std::max(patience, kOutdatedPatience)) throw;
      std::this_thread::sleep_for(kOutdatedPause);
    } catch (const MapBusy&) {
      if (waited() >= patience) throw;
    }
  }
}

void replaceMapFile(const fs::path& fresh, const fs::path& map) {
  const LowDescriptors low;
  exchange(fresh, map);
  syncFolderOf(map);  // nobody waits for the disk, which may take seconds
}

}  // namespace cluxel::rdf
