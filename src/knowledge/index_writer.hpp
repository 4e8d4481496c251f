// SPDX-License-Identifier: Apache-2.0
// Sorted changes into one index of 16-byte keys.
#pragma once

#include <vector>

#include "knowledge/lmdb_environment.hpp"
#include "knowledge/page_directory.hpp"

namespace cluxel {

/// Changes to an index: both lists ascending and without repetition, no key in both.
struct IndexChange {
  std::vector<Key128> added, removed;
};

/// Makes the change: appends behind the last key, puts single keys among many, and writes the index anew from
/// a merge when the change is large. Keys that are there already, or not there, do no harm.
void applyTo(ReadTransaction::Impl& transaction, Table index, const IndexChange& change);

}  // namespace cluxel
