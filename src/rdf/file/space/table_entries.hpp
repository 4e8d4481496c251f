// SPDX-License-Identifier: Apache-2.0
// Walks over a table of LMDB.
#pragma once

#include <string_view>

#include "rdf/file/lmdb_environment.hpp"

namespace cluxel::rdf {

/// Calls `visit` with the key and the value of each entry of a table, without reading long values.
template <typename Visit>
void forEachEntry(const ReadTransaction::Impl& state, MDB_dbi table, const Visit& visit) {
  MDB_cursor* raw = nullptr;
  state.check(mdb_cursor_open(state.live(), table, &raw), "read a table");
  const CursorHandle cursor(raw);
  MDB_val key;
  MDB_val value;
  int code = mdb_cursor_get(raw, &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &value, MDB_NEXT)) visit(toView(key), toView(value));
  if (code != MDB_NOTFOUND) state.check(code, "read a table");
}

}  // namespace cluxel::rdf
