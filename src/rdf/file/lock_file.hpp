// SPDX-License-Identifier: Apache-2.0
// The lock file of a map, LMDB's table of readers: who may make it, and whom it must not lock out.
#pragma once

#include <cstdint>
#include <filesystem>

#include "rdf/file/file_guards.hpp"

namespace cluxel::rdf {

std::filesystem::path lockFileOf(std::filesystem::path map);

enum class LockFileState : std::uint8_t {
  Usable,
  NoRoom,  ///< the disk is full
  Refused  ///< this process may not write it, or may not make it
};

struct LockFile {
  LockFileState state = LockFileState::Usable;
  int reason = 0;         ///< errno value when it is not usable
  Descriptor descriptor;  ///< of a usable one
};

/// Prepares the lock file of `map`, which is open as `descriptor`. Only a process that may write the map makes a lock
/// file: it gets the owner and the rights of the map, so that it locks out nobody who may write the map. Its bytes are
/// allocated, because LMDB makes it sparse, and writing to a hole on a full disk raises SIGBUS.
LockFile prepareLockFile(const std::filesystem::path& map, int descriptor, bool can_write);

/// Throws Error that names the lock file, its owner, and the remedy.
[[noreturn]] void failLockFile(const std::filesystem::path& map, const LockFile& lock);

}  // namespace cluxel::rdf
