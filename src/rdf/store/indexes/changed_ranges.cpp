// SPDX-License-Identifier: Apache-2.0
// Ranges are adjusted once, when the transaction commits.
#include "rdf/store/indexes/changed_ranges.hpp"

#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/store/indexes/index_directories.hpp"

namespace cluxel::rdf {

RangeSums& ChangedRanges::of(Table index, ReadTransaction::Impl& transaction) {
  std::optional<RangeSums>& ranges = ranges_[static_cast<std::size_t>(index)];
  if (!ranges) ranges = storedRanges(transaction, index);
  return *ranges;
}

/// A damaged index may lack a key that the others have. Then it could not follow a change of this key: the next reader
/// would miss an entry and refuse the whole map.
void ChangedRanges::store(WriteTransaction& transaction) {
  ReadTransaction::Impl& state = transaction.impl();
  for (std::size_t i = 0; i < kTableCount; ++i) {
    if (!ranges_[i]) continue;
    const auto index = static_cast<Table>(i);
    if (ranges_[i]->whole() != state.sums.of(index))
      refuseIndex(state.environment->file(), index, "differs from the others in what is changed; nothing was written");
    if (ranges_[i]->hasLong())
      ranges_[i]->splitLong(*state.directories->of(index, state), index, state.environment->file());
    ranges_[i]->joinShort();
    storeRanges(transaction, index, *ranges_[i]);
  }
}

}  // namespace cluxel::rdf
