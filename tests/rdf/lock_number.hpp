// SPDX-License-Identifier: Apache-2.0
// Puts an older number of the newest commit into a lock file.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>

#include "rdf/file/lock_file.hpp"

namespace cluxel::rdf {

/// What is left of a writer that was killed after the map got its commit, and before the lock file got the number.
/// False when the lock file has another number than `commit`. Another process does it, because this one would lose
/// LMDB's locks.
inline bool forgetNewestCommit(const std::filesystem::path& map, std::uint64_t commit) {
  constexpr off_t kNumber = 48;  // LMDB's place for it
  const pid_t child = ::fork();
  if (child == 0) {
    const int lock = ::open(lockFileOf(map).c_str(), O_RDWR | O_CLOEXEC);
    std::uint64_t number = 0;
    const bool is_there = ::pread(lock, &number, sizeof number, kNumber) == sizeof number && number == commit;
    --number;
    ::_exit(is_there && ::pwrite(lock, &number, sizeof number, kNumber) == sizeof number ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace cluxel::rdf
