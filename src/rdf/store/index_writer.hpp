// SPDX-License-Identifier: Apache-2.0
// Applies sorted changes to one index of 16-byte keys.
#pragma once

#include <span>
#include <vector>

#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/page_directory.hpp"

namespace cluxel::rdf {

/// Changes to an index: both lists are ascending, without duplicates, and disjoint.
struct IndexChange {
  std::vector<Key128> added, removed;
};

/// Appends ascending keys beyond the last one of an index. `cursor` is a cursor on it.
void appendKeys(const ReadTransaction::Impl& transaction, MDB_cursor* cursor, std::span<const QuadKey> keys);

/// Applies the change: appends keys after the last one, puts single keys, and rewrites the index by a merge when the
/// change is large. Adding an existing key or removing a missing one has no effect.
/// `sum` and `journal`, if any, follow what really changes; the journal takes keys in the order s, p, o, g.
void applyTo(ReadTransaction::Impl& transaction, Table index, const IndexChange& change, EntrySum* sum,
             QuadJournal* journal = nullptr);

}  // namespace cluxel::rdf
