// SPDX-License-Identifier: Apache-2.0
// What the system's files need before LMDB may have them: descriptors away from stdout, an identity, a lock file with
// room.
#pragma once

#include <sys/types.h>

#include <array>
#include <compare>
#include <filesystem>

namespace cluxel {

struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  auto operator<=>(const FileIdentity&) const = default;
};
FileIdentity identityOf(int descriptor, const std::filesystem::path& file);
/// Whether the name `file` leads to that file.
bool isNamed(const FileIdentity& identity, const std::filesystem::path& file);

/// Occupies the descriptors 0 to 2 as far as they are free: a map that got one of them would have messages written over
/// it.
class LowDescriptors {
 public:
  LowDescriptors();
  LowDescriptors(const LowDescriptors&) = delete;
  LowDescriptors& operator=(const LowDescriptors&) = delete;
  ~LowDescriptors();

 private:
  std::array<int, 3> taken_{-1, -1, -1};
};

/// Keeps a map file under its name: several may open it, or one may replace it. Held for moments. Where the file system
/// has no such locks nothing is held.
class NameLock {
 public:
  enum class Kind { Opening, Replacing };
  NameLock(int descriptor, Kind kind);
  NameLock(const NameLock&) = delete;
  NameLock& operator=(const NameLock&) = delete;
  ~NameLock();

 private:
  int descriptor_;
};

std::filesystem::path lockFileOf(std::filesystem::path map);

/// Makes the lock file of `map` and gives it its room on the disk: LMDB leaves holes in it, and on a full disk touching
/// one kills the process. Returns 0 or the system's error.
int reserveLockFile(const std::filesystem::path& map);

}  // namespace cluxel
