// SPDX-License-Identifier: Apache-2.0
// Copies a map table by table in key order, which fills all pages and leaves none free.
#include "cluxel/error.hpp"
#include "rdf/store/lmdb_environment.hpp"
#include "rdf/store/lock_file.hpp"

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
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(source.get(), &key, &value, MDB_NEXT))
    to.check(mdb_cursor_put(target.get(), &key, &value, duplicates ? MDB_APPENDDUP : MDB_APPEND), "write a table");
  if (code != MDB_NOTFOUND) from.check(code, "read a table");
}

void copyAll(const ReadTransaction& from, Environment& to) {
  WriteTransaction transaction = to.write();
  for (std::size_t i = 0; i < kTableCount; ++i) copyTable(from.impl(), transaction.impl(), static_cast<Table>(i));
  transaction.commit();
}

}  // namespace

void LmdbEnvironment::compactTo(const fs::path& target) const {
  const ReadTransaction snapshot = read();
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
