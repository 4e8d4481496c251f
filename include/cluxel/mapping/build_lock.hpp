// SPDX-License-Identifier: Apache-2.0
// One process at a time makes or remakes a map's file; what it does in between is nobody else's.
#pragma once

#include <filesystem>

namespace cluxel {

/// Held for a whole build, and while a map is compacted in place. A file `MAP.build-lock` carries it and goes with it;
/// that of a killed process locks nobody out. Readers, and updates of a finished map, are not kept off.
class BuildLock {
 public:
  /// Throws Error (StoreUnavailable), at once, that names the process which holds the lock.
  explicit BuildLock(const std::filesystem::path& map);
  BuildLock(const BuildLock&) = delete;
  BuildLock& operator=(const BuildLock&) = delete;
  ~BuildLock();

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace cluxel
