// SPDX-License-Identifier: Apache-2.0
// The LMDB environment and the state of transactions.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <span>
#include <thread>

#include "rdf/file/block_keys.hpp"
#include "rdf/file/check/store_sums.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/file/opening/lmdb_opening.hpp"
#include "rdf/file/table.hpp"
#include "rdf/store/quad_journal.hpp"

namespace cluxel::rdf {

class ChangedRanges;
class IndexDirectories;
class IndexDraft;
class StoreSnapshot;
struct CheckedParts;
class ValueCache;

/// The first format has no sums of quads and terms; the next commit adds them, which makes it the second. Up to the
/// third one, the index by object holds literals; up to the fourth one, an index has one sum, and none for its ranges;
/// up to the fifth one, index posg holds all quads, and there is no index psog.
inline constexpr int kFirstFormat = 1, kFormatWithSums = 2, kFormatWithoutLiterals = 4, kFormatWithRanges = 5,
                     kFormatWithNumbersApart = 6;

constexpr unsigned tableFlags(Table table) {
  switch (table) {
    case Table::Blocks:
      return 0;
    case Table::Terms:
      return MDB_INTEGERKEY;
    default:
      return MDB_DUPSORT | MDB_DUPFIXED;
  }
}

class LmdbEnvironment final : public Environment {
 public:
  /// `data_lock` is the file descriptor that holds the writer's lock; the environment takes ownership.
  LmdbEnvironment(std::filesystem::path file, OpenedLmdb opened, int data_lock);
  ~LmdbEnvironment() override;
  LmdbEnvironment(const LmdbEnvironment&) = delete;
  LmdbEnvironment& operator=(const LmdbEnvironment&) = delete;

  ReadTransaction read() const override;
  WriteTransaction write() override;
  const std::filesystem::path& file() const override { return file_; }
  void compactTo(const std::filesystem::path& target, CopiedPages pages) const override;
  /// Checks all pages of the snapshot's commit. Throws Error (StoreUnavailable) for damaged ones.
  void checkPages(const ReadTransaction::Impl& snapshot) const;

  std::uint64_t fileSize() const;   ///< at this moment
  std::uint64_t diskBytes() const;  ///< that the file takes on the disk; less than its size when it has holes
  bool hasOtherNames() const;       ///< hard links
  /// Gives the disk space of a part of the file back. False where the file system has no holes.
  bool punchHole(std::uint64_t begin, std::uint64_t bytes) const;
  MDB_env* handle() const { return handle_.get(); }
  MDB_dbi mainTable() const { return main_; }  ///< LMDB's table of tables, with the records of the format
  MDB_dbi table(Table table) const { return tables_[static_cast<std::size_t>(table)]; }
  ValueCache& values() const { return *values_; }
  /// The shared snapshot of commit `transaction_id`; `make` creates it on first use.
  std::shared_ptr<StoreSnapshot> snapshot(std::size_t transaction_id,
                                          const std::function<std::shared_ptr<StoreSnapshot>()>& make) const;
  void allowWriting();
  /// Notes which commit was checked when the file was opened. `for_writing`: the check was that of a writer
  /// (MapScope::Writing). `keys`: the keys of the blocks that it met.
  void noteStructure(std::size_t commit, bool for_writing, PresentKeys keys);
  /// The keys of a block table in a commit; absent when they are not known or out of order.
  std::optional<KeySum> presentKeys(std::size_t commit, std::string_view table) const;
  /// From now on the file may be renamed or removed.
  void loseName() { has_name_ = false; }
  /// True for a map that was written before its quads and terms had sums; it gets them with the next commit.
  bool isOfFirstFormat() const { return format_ == kFirstFormat; }
  /// False for a map whose index by object holds literals, too.
  bool omitsLiterals() const { return format_ >= kFormatWithoutLiterals; }
  /// Whether quads with numbers are in index psog instead of posg.
  bool keepsNumbersApart() const { return format_ >= kFormatWithNumbersApart; }
  /// The indexes of this map.
  std::span<const Table> indexes() const {
    return std::span(kIndexTables).first(kIndexTables.size() - (keepsNumbersApart() ? 0 : 1));
  }
  bool hasRanges() const { return format_ >= kFormatWithRanges; }
  /// Whether readers and writers compare what they read with its sums, part by part; else a writer compares all.
  bool isComparedByParts() const { return hasRanges() && !is_copy_; }
  /// Before anything is copied from a map: takes its format. The sums are copied last, so that nothing is compared.
  void startCopyOf(const LmdbEnvironment& other) {
    format_ = other.format_.load();
    is_copy_ = true;
  }
  /// For a page-by-page copy of `other`: the first commit stores `sums` under its own number.
  void startWithPagesOf(const LmdbEnvironment& other, const StoreSums& sums);
  /// True for the last commit of this process: what it read was verified, so what it wrote need not be.
  bool wrote(std::size_t transaction_id) const { return own_commit_ == transaction_id; }
  /// `checked`: of the commit before.
  void noteCommit(std::size_t transaction_id, std::shared_ptr<CheckedParts> checked, const BlockKeys& keys);
  /// Of an own commit what was compared of the commit before, else nothing.
  std::shared_ptr<CheckedParts> checkedPartsOf(std::size_t transaction_id) const;
  bool canWrite() const { return can_write_; }
  /// Whether this process is a forked child of the one that opened the file: it may neither read nor write with this
  /// environment, and opens another one.
  bool isOfParent() const;
  /// Throws Error (StoreUnavailable) when isOfParent().
  void refuseParents() const;
  /// Whether read() throws LockFileOutdated now. Cost: that of read().
  bool isOutdated() const;
  void check(int code, std::string_view doing) const { checkLmdb(code, file_, doing); }
  void enterWriting();
  void leaveWriting();
  /// Creates the databases of a new file or opens existing ones, and checks the format.
  void openTables();

 private:
  void lockAgainstProcesses();
  void requireName();
  void requireOneLockFile();
  void cutUnusedEnd() const;
  bool seesNewest(MDB_txn* reading) const;
  bool withoutWriters(const std::function<void()>& work) const;
  void createTables(ReadTransaction::Impl& transaction);
  void verifyForWriting(std::size_t commit);
  void startSums(WriteTransaction& transaction, std::size_t commit);

  std::filesystem::path file_;
  std::unique_ptr<JointUse> use_;  ///< none: no lock file
  EnvHandle handle_;
  int data_lock_;
  std::uint64_t forks_;  ///< forkCount() of the process that opened the file
  bool can_write_, has_name_ = true;
  std::atomic<bool> writing_allowed_{false};
  std::atomic<int> format_{kMapFormat};
  std::atomic<bool> is_copy_{false};
  std::optional<StoreSums> copied_sums_;  ///< for the first commit to a copy
  std::atomic<bool> verified_{false};     ///< writers may trust the file
  std::atomic<std::size_t> own_commit_{0}, structure_commit_{0};
  mutable std::mutex checked_mutex_;
  std::shared_ptr<CheckedParts> checked_;  ///< of the own commit
  std::size_t keys_commit_ = 0;
  PresentKeys keys_;  ///< of commit keys_commit_
  std::array<MDB_dbi, kTableCount> tables_{};
  MDB_dbi main_ = 0;
  std::unique_ptr<ValueCache> values_;
  mutable std::mutex snapshot_mutex_;
  mutable std::size_t snapshot_transaction_ = 0;
  mutable std::shared_ptr<StoreSnapshot> snapshot_;
  mutable std::mutex writer_mutex_;
  std::condition_variable writer_left_;
  bool writer_active_ = false;
  std::thread::id writer_thread_;
};

struct ReadTransaction::Impl {
  std::shared_ptr<LmdbEnvironment> environment;
  MDB_txn* txn = nullptr;
  bool writing = false;
  std::uint64_t committed_terms = 0;  ///< in a write transaction: the number of terms before it
  std::uint64_t generation = 0;       ///< incremented with each change in a write transaction
  BlockKeys block_keys;
  StoreSums sums;                           ///< of a write transaction
  QuadJournal journal;                      ///< of a write transaction
  std::uint64_t unwritten_bytes = 0;        ///< of a write transaction, since writePages()
  std::shared_ptr<StoreSnapshot> snapshot;  ///< created on first use, for this generation
  std::uint64_t snapshot_generation = 0;
  std::function<void()> flush_poll;  ///< of a FlushPoll
  std::unique_ptr<IndexDirectories> directories;
  std::unique_ptr<ChangedRanges> ranges;  ///< of a write transaction
  bool has_failed = false;                ///< a change failed: some indexes may have it, and others not
  unsigned threads = 1;                   ///< for sorting and merging the changes of indexes
  /// Of a write transaction: indexes of which most is new, written by commit(). Their tables hold what was there
  /// before.
  std::array<std::unique_ptr<IndexDraft>, kTableCount> drafts;

  Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl();
  MDB_dbi table(Table which) const { return environment->table(which); }
  /// Throws Error (StoreUnavailable) when a change of the transaction failed: it can only be rolled back.
  void requireSound() const;
  IndexDraft* draftOf(Table index) const { return drafts[static_cast<std::size_t>(index)].get(); }
  void check(int code, std::string_view doing) const { environment->check(code, doing); }
  /// `doing` is for the error, as in check().
  CursorHandle cursorOn(Table which, std::string_view doing) const;
  MDB_txn* live() const;  ///< throws when the transaction has ended, or was begun before this process was forked
  void end();
  /// Writes the pages that LMDB keeps in memory for a write transaction to the file.
  void writePages();
  /// Does so from 64 MiB on.
  void noteWritten(std::uint64_t bytes);
  /// The commit that is read, or on which the write transaction builds.
  std::size_t commitBefore() const { return mdb_txn_id(live()) - (writing ? 1 : 0); }
};

/// Adds the sums that a map of the first format lacks.
void makeSums(WriteTransaction& transaction);

/// As ReadTransaction::block().
std::optional<std::string_view> readBlock(ReadTransaction::Impl& transaction, std::string_view table,
                                          std::string_view key);
/// The bytes of a stored block under "table, zero byte, key". Throws Error when its checksum is wrong.
std::string_view verifiedBlock(std::string_view full_key, std::string_view stored, const std::filesystem::path& file);

}  // namespace cluxel::rdf
