// SPDX-License-Identifier: Apache-2.0
// Copies a map table by table in key order, which fills all pages and leaves none free.
#include "cluxel/error.hpp"
#include "rdf/file/check/map_structure.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

namespace fs = std::filesystem;

void copyTable(const ReadTransaction::Impl& from, const ReadTransaction::Impl& to, Table table) {
  MDB_cursor* raw = nullptr;
  from.check(mdb_cursor_open(from.live(), from.table(table), &raw), "read a table");
  const CursorHandle source(raw);
  to.check(mdb_cursor_open(to.live(), to.table(table), &raw), "write a table");
  const CursorHandle target(raw);
  const bool duplicates = table != Table::Blocks && table != Table::Terms;
  MDB_val key;
  MDB_val value;
  int code = mdb_cursor_get(source.get(), &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(source.get(), &key, &value, MDB_NEXT)) {
    if (table == Table::Blocks) verifiedBlock(toView(key), toView(value), from.environment->file());
    to.check(mdb_cursor_put(target.get(), &key, &value, duplicates ? MDB_APPENDDUP : MDB_APPEND), "write a table");
  }
  if (code != MDB_NOTFOUND) from.check(code, "read a table");
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
  WriteTransaction transaction = to.write();
  for (std::size_t i = 0; i < kTableCount; ++i) copyTable(from.impl(), transaction.impl(), static_cast<Table>(i));
  copyMainRecords(from.impl(), transaction.impl());
  const std::size_t commit = mdb_txn_id(from.impl().live());
  if (const auto sums = storedSums(from.impl(), commit))
    transaction.impl().sums = *sums;
  else
    makeSums(transaction);
  ++transaction.impl().generation;
  transaction.commit();
}

}  // namespace

void LmdbEnvironment::compactTo(const fs::path& target) const {
  const ReadTransaction snapshot = read();
  checkMapStructure(data_lock_, file_, mdb_txn_id(snapshot.impl().live()), MapScope::Whole);
  snapshotOf(snapshot.impl()).verify(snapshot.impl());
  std::shared_ptr<Environment> copy = Environment::open(target, OpenMode::Create);
  std::error_code ignored;
  try {
    copyAll(snapshot, *copy);
    copy.reset();
    fs::remove(lockFileOf(target), ignored);
  } catch (...) {
    copy.reset();
    fs::remove(target, ignored);
    fs::remove(lockFileOf(target), ignored);
    throw;
  }
}

}  // namespace cluxel::rdf
