// SPDX-License-Identifier: Apache-2.0
// Atomic replacement of a map file, and protection of writers from writing to a replaced file.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// Another process is changing the map, or copying it.
class MapBusy : public Error {
 public:
  explicit MapBusy(const std::filesystem::path& map);
  MapBusy(const std::filesystem::path& map, const std::string& what);
};

/// The file was replaced or removed since it was opened; writes to it would be lost.
class MapReplaced : public Error {
 public:
  explicit MapReplaced(const std::filesystem::path& map);
};

/// The lock file does not know the newest commit of a map that is open. That ends when all who have the map open by
/// this name close it.
class LockFileOutdated : public Error {
 public:
  explicit LockFileOutdated(const std::filesystem::path& map);
};

/// LMDB could not write a file, because the disk is full or fails. What stays unchanged by that, the caller may know
/// better: what() is about a map that was to be changed.
class NoSpaceLeft : public Error {
 public:
  /// `fault`: file and cause.
  explicit NoSpaceLeft(const std::string& fault)
      : Error(ErrorKind::StoreUnavailable, fault + "; the map keeps its last commit: free some space and run again"),
        fault_(fault) {}
  const std::string& fault() const { return fault_; }

 private:
  std::string fault_;
};

/// A write transaction on the file that is now called `map`; reopens it when it was replaced, or changed under another
/// name, during the wait. Throws MapBusy when another process still holds the lock after `patience` (at least 1.5 s),
/// and LockFileOutdated when other processes keep the map open as long with a lock file that is out of date.
WriteTransaction writeMap(const std::filesystem::path& map, std::chrono::milliseconds patience = {});

/// Renames `fresh`, which has no writer, to `map`. If `map` exists, the caller must hold a write transaction on it.
/// Readers of the old file continue; no process opens one map with the lock file of the other; the name refers to a
/// complete map at all times. Throws Error naming both files and leaves `fresh` in place.
void replaceMapFile(const std::filesystem::path& fresh, const std::filesystem::path& map);

}  // namespace cluxel::rdf
