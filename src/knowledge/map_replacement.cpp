// SPDX-License-Identifier: Apache-2.0
// Renaming over a map that others have open.
#include "cluxel/knowledge/map_replacement.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

#include "cluxel/base/file_bytes.hpp"
#include "knowledge/file_guards.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

/// Keeps others from opening a map, if there is one, while its name changes.
class HeldName {
 public:
  explicit HeldName(const fs::path& map) : descriptor_(::open(map.c_str(), O_RDWR | O_CLOEXEC)) {
    if (descriptor_ >= 0) lock_.emplace(descriptor_, NameLock::Kind::Replacing);
  }
  HeldName(const HeldName&) = delete;
  HeldName& operator=(const HeldName&) = delete;
  ~HeldName() {
    lock_.reset();
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  /// The rights of the file.
  std::optional<mode_t> mode() const {
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) return std::nullopt;
    return status.st_mode & 07777U;
  }

 private:
  int descriptor_;
  std::optional<NameLock> lock_;
};

}  // namespace

MapBusy::MapBusy(const fs::path& map)
    : Error(ExitCode::StoreUnavailable,
            map.string() + ": another process is writing to the map; wait until it has ended and run again") {}

MapReplaced::MapReplaced(const fs::path& map)
    : Error(ExitCode::StoreUnavailable, map.string() +
                                            ": was replaced or removed since it was opened (by compact, or a "
                                            "build with --force); nothing was written: run again") {}

WriteTransaction writeMap(const fs::path& map, std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  constexpr int kMostReplacements = 100;
  for (int replacements = 0;;) {
    try {
      return Environment::open(map, OpenMode::ReadWrite)->write();
    } catch (const MapReplaced&) {
      if (++replacements == kMostReplacements) throw;
    } catch (const MapBusy&) {
      if (std::chrono::steady_clock::now() >= deadline) throw;
    }
  }
}

void replaceMapFile(const fs::path& fresh, const fs::path& map) {
  const LowDescriptors low;
  const HeldName old_name(map), fresh_name(fresh);
  const fs::path lock = lockFileOf(map), old_lock = lock.string() + ".replaced";
  // A lock file counts the commits of its own map: the new one must never be opened with the old one's.
  std::rename(lock.c_str(), old_lock.c_str());
  if (old_name.mode()) (void)!::chmod(fresh.c_str(), *old_name.mode());
  if (std::rename(fresh.c_str(), map.c_str()) != 0) {
    const int reason = errno;
    std::rename(old_lock.c_str(), lock.c_str());
    throw Error(ExitCode::StoreUnavailable,
                fresh.string() + ": is whole, but cannot be moved to " + map.string() + ": " + std::strerror(reason));
  }
  std::rename(lockFileOf(fresh).c_str(), lock.c_str());  // whoever reads the new map already is registered there
  ::unlink(old_lock.c_str());
  syncFolderOf(map);
}

}  // namespace cluxel
