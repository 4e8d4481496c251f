// SPDX-License-Identifier: Apache-2.0
// Compares the number in the lock file with those in the meta pages.
#include "rdf/file/opening/newest_commit.hpp"

#include <chrono>
#include <thread>

#include "rdf/file/map_replacement.hpp"

namespace cluxel::rdf {

namespace {

constexpr auto kPatience = std::chrono::milliseconds(1500);
constexpr auto kPause = std::chrono::milliseconds(2);

bool seesNewest(MDB_txn* reading, const std::filesystem::path& file) {
  mdb_txn_reset(reading);
  checkLmdb(mdb_txn_renew(reading), file, "read the map");
  return mdb_txn_id(reading) == newestCommit(mdb_txn_env(reading));
}

/// LMDB corrects the number when it finds that the last writer died with its lock.
void repairNumber(MDB_env* handle) {
  MDB_txn* writing = nullptr;
  if (mdb_txn_begin(handle, nullptr, 0, &writing) == MDB_SUCCESS) mdb_txn_abort(writing);
}

}  // namespace

std::size_t newestCommit(MDB_env* handle) {
  MDB_envinfo info{};
  mdb_env_info(handle, &info);
  return info.me_last_txnid;
}

bool reachesNewest(MDB_txn* reading, const std::filesystem::path& file, const JointUse& use,
                   const WithoutWriters& without_writers) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!seesNewest(reading, file)) {
    bool sees = false;
    const bool is_final = without_writers([&] {
      sees = seesNewest(reading, file);
      if (sees) return;
      repairNumber(mdb_txn_env(reading));
      sees = seesNewest(reading, file);
    });
    if (is_final) return sees;
    // A commit is complete when its number is in the lock file; it reaches the meta page before, and waits for the
    // disk.
    const bool is_being_written = mdb_txn_id(reading) + 1 == newestCommit(mdb_txn_env(reading));
    if (is_being_written && !use.hasOtherLockFiles()) return true;
    if (std::chrono::steady_clock::now() > deadline) throw MapBusy(file);
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

}  // namespace cluxel::rdf
