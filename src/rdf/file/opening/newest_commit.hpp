// SPDX-License-Identifier: Apache-2.0
// Whether a transaction sees the newest commit of its file: LMDB asks the lock file for its number, not the file.
#pragma once

#include <filesystem>
#include <functional>

#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/opening/joint_use.hpp"

namespace cluxel::rdf {

/// The newest commit in the file. Cost: nanoseconds.
std::size_t newestCommit(MDB_env* handle);

/// Runs its argument while no process and no thread writes the map; false, without running it, when one does.
using WithoutWriters = std::function<bool(const std::function<void()>&)>;

/// For a read transaction that does not see the newest commit: renews it until it does, or until that commit is known
/// to be just being written. False when the lock file has a wrong number. Repairs the number where a process was killed
/// while it committed. Throws MapBusy after 1.5 s.
bool reachesNewest(MDB_txn* reading, const std::filesystem::path& file, const JointUse& use,
                   const WithoutWriters& without_writers);

}  // namespace cluxel::rdf
