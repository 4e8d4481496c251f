// SPDX-License-Identifier: Apache-2.0
// The sums of ranges of a write transaction, which follow what it changes.
#pragma once

#include <array>
#include <optional>

#include "rdf/file/check/range_sums.hpp"

namespace cluxel::rdf {

class ChangedRanges {
 public:
  /// Those of an index before its next change; they are read when its first key changes.
  RangeSums& of(Table index, ReadTransaction::Impl& transaction);
  /// For an index that was written anew.
  void replace(Table index, RangeSums ranges) { ranges_[static_cast<std::size_t>(index)] = std::move(ranges); }
  /// To be called by a commit, after all indexes were written.
  void store(WriteTransaction& transaction);

 private:
  std::array<std::optional<RangeSums>, kTableCount> ranges_;  ///< of indexes that changed
};

}  // namespace cluxel::rdf
