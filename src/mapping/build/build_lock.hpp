// SPDX-License-Identifier: Apache-2.0
// A lock file: at most one process builds, changes, merges or compacts a map.
#pragma once

#include <filesystem>

namespace cluxel::mapping {

/// Held by build, extend, retract, repose, state, rules apply, merge (on its output) and compact in place, from start
/// to end. The lock is on `MAP.build-lock`, which is removed at the end. A lock file of a killed process blocks nobody.
/// Readers, `update` and `load` do not take it.
class BuildLock {
 public:
  /// Never waits: throws rdf::MapBusy, naming the process that holds the lock, or Error (StoreUnavailable).
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
