// SPDX-License-Identifier: Apache-2.0
// Copies a map table by table in key order, which fills all pages and leaves none free, or page by page.
#include <fcntl.h>

#include <cerrno>
#include <optional>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_structure.hpp"
#include "rdf/file/commit_stamps.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/page_directory.hpp"
#include "rdf/store/indexes/index_directories.hpp"
#include "rdf/store/indexes/index_writer.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

namespace fs = std::filesystem;

/// Commits now and then: LMDB keeps what a transaction has written in memory.
class CopyTarget {
 public:
  explicit CopyTarget(Environment& to) : to_(to) { transaction_.emplace(to.write()); }

  WriteTransaction& transaction() { return *transaction_; }
  const ReadTransaction::Impl& impl() { return transaction_->impl(); }

  /// Where the next keys of the table go, in ascending order. `bytes` are those that follow.
  MDB_cursor* cursorFor(Table table, std::size_t bytes) {
    constexpr std::size_t kMaxBytes = std::size_t{128} << 20U;
    if (written_ > 0 && written_ + bytes > kMaxBytes) {
      cursor_.reset();
      ++transaction_->impl().generation;  // so that the commit writes its sums; those of the last one count
      transaction_->commit();
      transaction_.reset();
      transaction_.emplace(to_.write());
      written_ = 0;
    }
    if (!cursor_ || table != table_) cursor_ = impl().cursorOn(table_ = table, "write a table");
    written_ += bytes;
    return cursor_.get();
  }

  void closeCursor() { cursor_.reset(); }

 private:
  Environment& to_;
  std::optional<WriteTransaction> transaction_;
  CursorHandle cursor_;  ///< closed before the transaction
  Table table_ = Table::Terms;
  std::size_t written_ = 0;
};

void copyTable(const ReadTransaction::Impl& from, CopyTarget& to, Table table) {
  const CursorHandle source = from.cursorOn(table, "read a table");
  MDB_val key;
  MDB_val value;
  int code = mdb_cursor_get(source.get(), &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(source.get(), &key, &value, MDB_NEXT)) {
    if (table == Table::Blocks) verifiedBlock(toView(key), toView(value), from.environment->file());
    MDB_cursor* target = to.cursorFor(table, key.mv_size + value.mv_size);
    to.impl().check(mdb_cursor_put(target, &key, &value, MDB_APPEND), "write a table");
  }
  if (code != MDB_NOTFOUND) from.check(code, "read a table");
}

void copyIndex(const ReadTransaction::Impl& from, CopyTarget& to, Table index) {
  const CursorHandle source = from.cursorOn(index, "read an index");
  const PageDirectory pages(source.get());
  for (std::size_t i = 0; i < pages.pageCount(); ++i) {
    const auto keys = pages.page(i);
    MDB_cursor* target = to.cursorFor(index, keys.size_bytes());
    appendKeys(to.impl(), target, keys);
    to.impl().directories->noteRewritten(index, 1);
  }
}

/// The format and the sums of block keys; tables, which stand in the same database, have their own copies.
void copyMainRecords(const ReadTransaction::Impl& from, const ReadTransaction::Impl& to) {
  MDB_cursor* raw = nullptr;
  from.check(mdb_cursor_open(from.live(), from.environment->mainTable(), &raw), "read a table");
  const CursorHandle source(raw);
  MDB_val key;
  MDB_val value;
  for (int code = mdb_cursor_get(raw, &key, &value, MDB_FIRST); code == MDB_SUCCESS;
       code = mdb_cursor_get(raw, &key, &value, MDB_NEXT))
    if (toView(key).starts_with("cluxel-keys:") || toView(key) == "cluxel-format")
      to.check(mdb_put(to.live(), to.environment->mainTable(), &key, &value, 0), "write a table");
}

void copyAll(const ReadTransaction& from, Environment& to) {
  CopyTarget target(to);
  target.impl().environment->startCopyOf(*from.impl().environment);  // the new file was created in the newest format
  for (const Table index : target.impl().environment->indexes()) copyIndex(from.impl(), target, index);
  // The long blocks last: LMDB searches all pages of a transaction at each write.
  for (const Table table : {Table::Terms, Table::Blocks}) copyTable(from.impl(), target, table);
  target.closeCursor();
  WriteTransaction& transaction = target.transaction();
  const LmdbEnvironment& environment = *transaction.impl().environment;
  if (!environment.keepsNumbersApart())  // earlier programs know no such table
    environment.check(mdb_drop(transaction.impl().live(), environment.table(Table::Psog), 1), "write a table");
  copyMainRecords(from.impl(), transaction.impl());
  carryStamps(from, transaction);
  const std::size_t commit = mdb_txn_id(from.impl().live());
  if (const auto sums = storedSums(from.impl(), commit))
    transaction.impl().sums = *sums;
  else
    makeSums(transaction);
  ++transaction.impl().generation;
  transaction.commit();
}

/// A new map file. In the end its lock file is removed, and the map, too, unless it is to be kept.
class MadeFile {
 public:
  explicit MadeFile(const fs::path& file) : file_(file) {}
  MadeFile(const MadeFile&) = delete;
  MadeFile& operator=(const MadeFile&) = delete;
  ~MadeFile() {
    std::error_code ignored;
    fs::remove(lockFileOf(file_), ignored);
    if (!is_kept_) fs::remove(file_, ignored);
  }
  void keep() { is_kept_ = true; }

 private:
  const fs::path& file_;
  bool is_kept_ = false;
};

/// Copies the pages of the newest commit that are not free. False when that is not `from` any more, or LMDB refuses.
bool copyPages(const ReadTransaction& from, const fs::path& target, int file) {
  const LmdbEnvironment& environment = *from.impl().environment;
  const int code = mdb_env_copyfd2(environment.handle(), file, MDB_CP_COMPACT);
  if (code > 0) failStore(target, code, "write the map");  // of the system: the disk is full, for instance
  return code == MDB_SUCCESS && environment.read().commitNumber() == from.commitNumber();
}

void verifyBlocks(const ReadTransaction::Impl& from) {
  const CursorHandle source = from.cursorOn(Table::Blocks, "read a table");
  MDB_val key;
  MDB_val value;
  int code = mdb_cursor_get(source.get(), &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(source.get(), &key, &value, MDB_NEXT))
    verifiedBlock(toView(key), toView(value), from.environment->file());
  if (code != MDB_NOTFOUND) from.check(code, "read a table");
}

/// Some records carry the number of their commit. A copy counts its commits anew, so these records are written again.
void renumber(const ReadTransaction& from, const StoreSums& sums, const fs::path& target) {
  const auto copy = std::dynamic_pointer_cast<LmdbEnvironment>(Environment::open(target, OpenMode::ReadWrite));
  copy->startWithPagesOf(*from.impl().environment, sums);
  WriteTransaction transaction = copy->write();
  carryStamps(from, transaction);
  ++transaction.impl().generation;
  transaction.commit();
}

/// False where the entries have to be copied one by one.
bool copyAsItIs(const ReadTransaction& from, const fs::path& target) {
  const auto sums = storedSums(from.impl(), mdb_txn_id(from.impl().live()));
  if (!sums) return false;
  verifyBlocks(from.impl());
  const LowDescriptors low;
  Descriptor file(::open(target.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) failStore(target, errno, "create the map");
  MadeFile made(target);
  if (!copyPages(from, target, file.get())) return false;
  renumber(from, *sums, target);
  made.keep();
  return true;
}

void copyEntries(const ReadTransaction& from, const fs::path& target) {
  std::shared_ptr<Environment> copy = Environment::open(target, OpenMode::Create);
  MadeFile made(target);
  try {
    copyAll(from, *copy);
  } catch (...) {
    copy.reset();  // before the file goes
    throw;
  }
  copy.reset();
  made.keep();
}

}  // namespace

void LmdbEnvironment::checkPages(const ReadTransaction::Impl& snapshot) const {
  checkMapStructure(data_lock_, file_, mdb_txn_id(snapshot.live()), MapScope::Whole);
}

void LmdbEnvironment::compactTo(const fs::path& target, CopiedPages pages) const {
  const ReadTransaction snapshot = read();
  checkPages(snapshot.impl());
  snapshotOf(snapshot.impl()).verify(snapshot.impl());
  const bool is_copied = pages == CopiedPages::AsTheyAre && !fs::exists(target) && copyAsItIs(snapshot, target);
  if (!is_copied) copyEntries(snapshot, target);
}

}  // namespace cluxel::rdf
