// SPDX-License-Identifier: Apache-2.0
// The single writer among threads and processes, and what keeps commits from being lost when the map has two names.
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "rdf/file/file_guards.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/file/opening/newest_commit.hpp"

namespace cluxel::rdf {

namespace {

constexpr auto kOtherNamesPatience = std::chrono::milliseconds(1500);
constexpr auto kOtherNamesPause = std::chrono::milliseconds(10);

}  // namespace

void LmdbEnvironment::allowWriting() {
  if (!can_write_) failStore(file_, EACCES, "open the map for writing");
  writing_allowed_ = true;
  int dead_readers = 0;
  check(mdb_reader_check(handle(), &dead_readers), "drop the readers that were killed");
}

void LmdbEnvironment::lockAgainstProcesses() {
  lockAgainstWriters(data_lock_, WriteLock::Writing, file_);
  try {
    requireName();
    requireOneLockFile();
  } catch (...) {
    ::flock(data_lock_, LOCK_UN);
    throw;
  }
}

/// A writer reuses the pages that no reader in its own lock file reads. Others would read what it writes over them, and
/// their lock file would not know of the commit.
void LmdbEnvironment::requireOneLockFile() {
  if (!use_) return;
  const auto deadline = std::chrono::steady_clock::now() + kOtherNamesPatience;
  while (use_->hasOtherLockFiles()) {
    if (std::chrono::steady_clock::now() > deadline) {
      throw MapBusy(file_,
                    "another process has the map open under another name (it was moved, or has a hard link), in a "
                    "container that it is mounted into as a single file, or with a lock file that was removed; nothing "
                    "was written: end that process, or wait until it has ended, and run again");
    }
    std::this_thread::sleep_for(kOtherNamesPause);
  }
}

/// The previous lock holder may have replaced the file.
void LmdbEnvironment::requireName() {
  if (!has_name_ || isNamed(identityOf(data_lock_, file_), file_)) return;
  throw MapReplaced(file_);
}

void LmdbEnvironment::enterWriting() {
  if (!writing_allowed_)
    throw Error(ErrorKind::StoreUnavailable, file_.string() + ": the map was opened for reading only");
  refuseParents();
  std::unique_lock lock(writer_mutex_);
  if (writer_active_ && writer_thread_ == std::this_thread::get_id())
    throw std::logic_error("a thread cannot write in two transactions of one map at once");
  writer_left_.wait(lock, [this] { return !writer_active_; });
  try {
    lockAgainstProcesses();
  } catch (...) {
    writer_left_.notify_one();  // the thread before woke this one only
    throw;
  }
  writer_active_ = true;
  writer_thread_ = std::this_thread::get_id();
}

/// A commit that fails, or is killed, leaves pages behind the last one of the newest commit. No list of free pages has
/// them, and no snapshot reads them: every commit has at least the pages of those before.
void LmdbEnvironment::cutUnusedEnd() const {
  if (!verified_) return;  // the number of the last page may be damaged
  MDB_envinfo info{};
  MDB_stat stat{};
  if (mdb_env_info(handle(), &info) != MDB_SUCCESS || mdb_env_stat(handle(), &stat) != MDB_SUCCESS) return;
  const std::uint64_t used = (std::uint64_t{info.me_last_pgno} + 1) * stat.ms_psize;
  struct stat status {};
  if (::fstat(data_lock_, &status) != 0 || static_cast<std::uint64_t>(status.st_size) <= used) return;
  (void)!::ftruncate(data_lock_, static_cast<off_t>(used));  // where that fails, the map is sound, and only longer
}

void LmdbEnvironment::leaveWriting() {
  cutUnusedEnd();
  ::flock(data_lock_, LOCK_UN);
  {
    const std::lock_guard lock(writer_mutex_);
    writer_active_ = false;
  }
  writer_left_.notify_one();
}

bool LmdbEnvironment::withoutWriters(const std::function<void()>& work) const {
  // A thread that waits until another process has written holds the mutex. Readers do not wait with it.
  const std::unique_lock lock(writer_mutex_, std::try_to_lock);
  return lock.owns_lock() && !writer_active_ && runWithoutWriters(data_lock_, file_, work);
}

/// LMDB takes the number of the newest commit from the lock file.
bool LmdbEnvironment::seesNewest(MDB_txn* reading) const {
  if (!use_ || mdb_txn_id(reading) == newestCommit(handle())) return true;
  const auto without_writers = [this](const auto& work) { return withoutWriters(work); };
  return reachesNewest(reading, file_, *use_, without_writers);
}

bool LmdbEnvironment::isOutdated() const {
  MDB_txn* raw = nullptr;
  check(mdb_txn_begin(handle(), nullptr, MDB_RDONLY, &raw), "read the map");
  const TxnHandle reading(raw);
  return !seesNewest(raw);
}

}  // namespace cluxel::rdf
