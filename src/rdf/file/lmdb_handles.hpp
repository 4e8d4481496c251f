// SPDX-License-Identifier: Apache-2.0
// Owning LMDB handles, and LMDB's error codes as exceptions.
#pragma once

#include <lmdb.h>

#include <filesystem>
#include <memory>
#include <string_view>

namespace cluxel::rdf {

struct LmdbDeleter {
  void operator()(MDB_env* environment) const { mdb_env_close(environment); }
  void operator()(MDB_cursor* cursor) const { mdb_cursor_close(cursor); }
  void operator()(MDB_txn* transaction) const { mdb_txn_abort(transaction); }
};
using EnvHandle = std::unique_ptr<MDB_env, LmdbDeleter>;
using CursorHandle = std::unique_ptr<MDB_cursor, LmdbDeleter>;
using TxnHandle = std::unique_ptr<MDB_txn, LmdbDeleter>;

inline MDB_val toVal(std::string_view bytes) {
  return {bytes.size(), const_cast<char*>(bytes.data())};
}
inline std::string_view toView(const MDB_val& value) {
  return {static_cast<const char*>(value.mv_data), value.mv_size};
}

/// Throws Error (StoreUnavailable): "file: cause; remedy".
[[noreturn]] void failStore(const std::filesystem::path& file, int code, std::string_view doing);

inline void checkLmdb(int code, const std::filesystem::path& file, std::string_view doing) {
  if (code != MDB_SUCCESS) failStore(file, code, doing);
}

}  // namespace cluxel::rdf
