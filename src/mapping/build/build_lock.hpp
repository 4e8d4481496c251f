// SPDX-License-Identifier: Apache-2.0
// A lock file: at most one process builds or compacts a map.
#pragma once

#include <filesystem>

namespace cluxel::mapping {

/// Held for a whole build, and while a map is compacted in place. The lock is on the file `MAP.build-lock`, which is
/// removed at the end; that of a killed process does not block others. Readers, and updates of a finished map, are not
/// blocked.
class BuildLock {
 public:
  /// Never waits: throws Error (StoreUnavailable), naming the process that holds the lock.
  explicit BuildLock(const std::filesystem::path& map);
  BuildLock(const BuildLock&) = delete;
  BuildLock& operator=(const BuildLock&) = delete;
  ~BuildLock();

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Whether a process holds the lock, or was killed while it did.
bool hasBuildLock(const std::filesystem::path& map);

/// False when this process has no right to write a map, its lock files, or the folder. `map` need not exist.
bool mayWriteMap(const std::filesystem::path& map);

}  // namespace cluxel::mapping
