// SPDX-License-Identifier: Apache-2.0
// Applies sorted changes to one index of 16-byte keys.
#pragma once

#include <functional>
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

/// A change of one index. The sums and the journal, if any, follow what really changes. They take keys in the order s,
/// p, o, g.
struct IndexTask {
  Table index = Table::Spog;
  IndexChange change = {};
  EntrySum* sum = nullptr;
  QuadJournal* journal = nullptr;
  EntrySum* sum_of_numbers = nullptr;          ///< of those quads whose object is a number
  std::function<bool(TermId)> is_number = {};  ///< set with it; several threads may call it
};

/// Applies a change of `count` keys to one index or more: by single puts, or to a draft when the change is large.
/// Adding an existing key or removing a missing one has no effect. `make` fills in the change of a task; it runs on as
/// many threads as the transaction may use, once for each task, as does what changes drafts.
void applyTo(ReadTransaction::Impl& transaction, std::span<IndexTask> tasks, std::size_t count,
             const std::function<void(IndexTask&)>& make);

/// Writes the drafts of a transaction to their tables, which fills all pages.
void writeDrafts(ReadTransaction::Impl& transaction);

}  // namespace cluxel::rdf
