// SPDX-License-Identifier: Apache-2.0
// Copies a map table by table in key order, which fills all pages and leaves none free.
#include "cluxel/error.hpp"
#include "rdf/file/check/map_structure.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/page_directory.hpp"
#include "rdf/store/index_writer.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

namespace fs = std::filesystem;

CursorHandle cursorOn(const ReadTransaction::Impl& state, Table table, const char* doing) {
  MDB_cursor* raw = nullptr;
  state.check(mdb_cursor_open(state.live(), state.table(table), &raw), doing);
  return CursorHandle(raw);
}

void copyTable(const ReadTransaction::Impl& from, const ReadTransaction::Impl& to, Table table) {
  const CursorHandle source = cursorOn(from, table, "read a table"), target = cursorOn(to, table, "write a table");
  MDB_val key;
  MDB_val value;
  int code = mdb_cursor_get(source.get(), &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(source.get(), &key, &value, MDB_NEXT)) {
    if (table == Table::Blocks) verifiedBlock(toView(key), toView(value), from.environment->file());
    to.check(mdb_cursor_put(target.get(), &key, &value, MDB_APPEND), "write a table");
  }
  if (code != MDB_NOTFOUND) from.check(code, "read a table");
}

void copyIndex(const ReadTransaction::Impl& from, const ReadTransaction::Impl& to, Table index) {
  const CursorHandle source = cursorOn(from, index, "read an index"), target = cursorOn(to, index, "write an index");
  const PageDirectory pages(source.get());
  for (std::size_t i = 0; i < pages.pageCount(); ++i) appendKeys(to, target.get(), pages.page(i));
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
  // The long blocks last: LMDB searches all pages of a transaction at each write.
  for (const Table index : {Table::TermHashes, Table::Spog, Table::Posg, Table::Ospg, Table::Gspo})
    copyIndex(from.impl(), transaction.impl(), index);
  for (const Table table : {Table::Terms, Table::Blocks}) copyTable(from.impl(), transaction.impl(), table);
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
