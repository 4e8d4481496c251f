// SPDX-License-Identifier: Apache-2.0
// Preparations before LMDB opens a file: safe descriptors, file identity, and a preallocated lock file.
#pragma once

#include <sys/types.h>

#include <array>
#include <compare>
#include <filesystem>

namespace cluxel::rdf {

struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  auto operator<=>(const FileIdentity&) const = default;
};
FileIdentity identityOf(int descriptor, const std::filesystem::path& file);
/// True when the path `file` refers to that file.
bool isNamed(const FileIdentity& identity, const std::filesystem::path& file);

/// Occupies the free ones of descriptors 0 to 2: a map opened as one of them would be overwritten by messages to stdout
/// or stderr.
class LowDescriptors {
 public:
  LowDescriptors();
  LowDescriptors(const LowDescriptors&) = delete;
  LowDescriptors& operator=(const LowDescriptors&) = delete;
  ~LowDescriptors();

 private:
  std::array<int, 3> taken_{-1, -1, -1};
};

/// A shared lock for opening a map file by its name, or an exclusive one for replacing it. Held briefly. Has no effect
/// on file systems without such locks.
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

/// Creates and preallocates the lock file of `map`: LMDB makes it sparse, and writing to a hole on a full disk raises
/// SIGBUS. Returns 0 or the errno value.
int reserveLockFile(const std::filesystem::path& map);

}  // namespace cluxel::rdf
