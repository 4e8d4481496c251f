// SPDX-License-Identifier: Apache-2.0
// A hash table of term ids in one array: a search touches one place of memory, and its release costs nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "sparql/values/value.hpp"

namespace cluxel::sparql {

/// Ids by the hash of their terms. Equal hashes are told apart by a test of the caller.
class IdTable {
 public:
  /// The id with this hash for which `is_same(id)` holds; kUnbound when there is none.
  template <typename IsSame>
  ValueId find(std::size_t hash, IsSame is_same) const {
    if (entries_.empty()) return kUnbound;
    for (std::size_t at = placeOf(hash); entries_[at].id != kUnbound; at = next(at))
      if (entries_[at].hash == hash && is_same(entries_[at].id)) return entries_[at].id;
    return kUnbound;
  }
  /// The id must not be in the table.
  void insert(std::size_t hash, ValueId id) {
    if (2 * (count_ + 1) > entries_.size()) grow();
    put({hash, id});
    ++count_;
  }
  /// The id must be in the table with this hash.
  void erase(std::size_t hash, ValueId id) {
    std::size_t hole = placeOf(hash);
    while (entries_[hole].id != id) hole = next(hole);
    // Backward-shift deletion: later entries of the run fill the hole, but none moves before the place of its hash.
    for (std::size_t at = next(hole); entries_[at].id != kUnbound; at = next(at)) {
      const std::size_t way = (at - placeOf(entries_[at].hash)) & mask();
      if (way < ((at - hole) & mask())) continue;
      entries_[hole] = entries_[at];
      hole = at;
    }
    entries_[hole] = {};
    --count_;
  }

 private:
  struct Entry {
    std::size_t hash = 0;
    ValueId id = kUnbound;
  };
  std::size_t mask() const { return entries_.size() - 1; }
  std::size_t placeOf(std::size_t hash) const { return (hash * 0x9E3779B97F4A7C15ULL >> 20U) & mask(); }
  std::size_t next(std::size_t at) const { return (at + 1) & mask(); }
  void put(const Entry& entry) {
    std::size_t at = placeOf(entry.hash);
    while (entries_[at].id != kUnbound) at = next(at);
    entries_[at] = entry;
  }
  void grow() {
    constexpr std::size_t kFirstSize = 16;
    const std::vector<Entry> old =
        std::exchange(entries_, std::vector<Entry>(std::max(kFirstSize, 2 * entries_.size())));
    for (const Entry& entry : old)
      if (entry.id != kUnbound) put(entry);
  }

  std::vector<Entry> entries_;  ///< a power of two, at most half of them used
  std::size_t count_ = 0;
};

}  // namespace cluxel::sparql
