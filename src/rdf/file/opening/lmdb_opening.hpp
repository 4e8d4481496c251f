// SPDX-License-Identifier: Apache-2.0
// Opens a map in LMDB, with a lock file that belongs to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "rdf/file/environment.hpp"
#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/opening/joint_use.hpp"

namespace cluxel::rdf {

/// What is to be opened.
struct LmdbRequest {
  const std::filesystem::path& file;
  int descriptor = -1;  ///< of the file
  std::uint64_t file_size = 0;
  OpenMode mode = OpenMode::ReadOnly;
  bool can_write = true;  ///< this process may write the file
  unsigned flags = 0;     ///< of LMDB, where it may be written
};

enum class LmdbOutcome : std::uint8_t {
  Opened,
  Renamed,    ///< the name refers to another file by now
  NeedsCopy,  ///< this process cannot register as a reader, so it has to read a private copy
  // Only while the map is being opened:
  Taken,            ///< another process is opening a map with the lock file
  ForeignLockFile,  ///< the lock file serves another file that had the name
  OutdatedLockFile  ///< the lock file does not know the newest commit
};

struct OpenedLmdb {
  LmdbOutcome outcome = LmdbOutcome::Opened;
  std::unique_ptr<JointUse> use;  ///< none: the map is open without a lock file
  EnvHandle handle;               ///< to be closed before `use`
  bool can_write = true;
  bool holds_writers = false;  ///< has no lock file, but the writers' lock until it closes the file
};

/// Reserves as much address space as possible, so that a map does not outgrow its mapping. `name` is what LMDB opens,
/// and `file` what errors name. `file_size` in bytes.
EnvHandle openLmdb(const std::filesystem::path& name, const std::filesystem::path& file, std::uint64_t file_size,
                   unsigned flags);

/// Opens the file while its name refers to it. A lock file that still serves another file, which had the name before,
/// is set aside: its users keep it. Where that is not possible and the map is to be written, throws Error
/// (StoreUnavailable), or LockFileOutdated when the number of the lock file is wrong; MapBusy when another process
/// writes all the time.
OpenedLmdb openLmdbByName(const LmdbRequest& request);

}  // namespace cluxel::rdf
