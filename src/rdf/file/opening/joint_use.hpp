// SPDX-License-Identifier: Apache-2.0
// Which lock file a map is used with: LMDB finds a lock file by the name of the map, and names can change.
#pragma once

#include <sys/types.h>

#include <cstdint>

#include "rdf/file/file_guards.hpp"

namespace cluxel::rdf {

/// A process that has a map open marks the map with its lock file, and the lock file with its map, so that others see
/// when a lock file serves two maps, or a map has two lock files. That happens when a map is moved or replaced while a
/// process has it open, or has two names (a hard link). A mark is a shared lock on a byte far behind the end of the
/// file; the position of the byte tells the other file. Has no effect on file systems without such locks, and on
/// network file systems, where such a lock would keep out writers.
class JointUse {
 public:
  /// Marks both. `map` must stay open while this object lives. The lock file is closed at the end, so LMDB must have
  /// closed it before: a process loses LMDB's locks on a file with any descriptor of it.
  JointUse(int map, Descriptor lock_file);
  JointUse(const JointUse&) = delete;
  JointUse& operator=(const JointUse&) = delete;
  ~JointUse();

  int lockFile() const { return lock_file_.get(); }  ///< its descriptor
  /// Whether some process, also this one, uses the lock file for another map.
  bool isLockFileOfOthers() const;
  /// Whether another process has the map open with this lock file.
  bool hasCompany() const;
  /// Whether another process has the map open with another lock file. Cost: two system calls.
  bool hasOtherLockFiles() const;

 private:
  int map_;
  Descriptor lock_file_;
  std::uint64_t forks_;                 ///< forkCount() of the process that made the marks
  off_t map_mark_ = 0, lock_mark_ = 0;  ///< the byte in the map, and that in the lock file; 0: there is none
};

}  // namespace cluxel::rdf
