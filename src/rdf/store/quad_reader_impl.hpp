// SPDX-License-Identifier: Apache-2.0
// The state of a quad reader, and key ranges of prefixes.
#pragma once

#include <unordered_map>

#include "rdf/file/check/page_guard.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

constexpr Table tableOf(QuadOrder order) {
  return static_cast<Table>(static_cast<std::size_t>(Table::Spog) + static_cast<std::size_t>(order));
}

/// A range of keys with a common prefix.
struct KeyRange {
  Key128 first = 0, last = 0;  ///< inclusive
};

/// The range of the first `length` ids in index order.
inline KeyRange rangeOf(std::span<const TermId> prefix) {
  Key128 first = 0;
  for (const TermId id : prefix) first = (first << 32U) | id;
  const auto missing = static_cast<unsigned>(32 * (4 - prefix.size()));
  if (missing == 128) return {0, ~Key128{0}};
  first <<= missing;
  return {first, first | ((Key128{1} << missing) - 1)};
}

/// The keys of a range among ascending keys.
std::span<const QuadKey> keysWithin(std::span<const QuadKey> keys, const KeyRange& range);

inline Key128 toNumber(const QuadIds& quad, QuadOrder order) {
  const std::array<TermId, 4> ids = {quad.s, quad.p, quad.o, quad.g};
  Key128 key = 0;
  for (const std::uint8_t place : placesOf(order)) key = (key << 32U) | ids[place];
  return key;
}

/// A pattern in the order of an index: a key range, and a mask test for the other bound positions.
struct IndexPattern {
  KeyRange range;
  Key128 mask = 0, value = 0;  ///< a key of the range matches when (key & mask) == value
  std::size_t prefix_length = 0;
  bool filtered = false;
};
IndexPattern layOut(const QuadPattern& pattern, QuadOrder order);

struct QuadReader::Impl {
  ReadTransaction transaction;
  std::uint64_t committed_terms = 0;                    ///< ids below it may be in the environment's value cache
  std::unordered_map<TermId, DecodedValue> own_values;  ///< of uncommitted terms
  TermId last_datatype = kNoTerm;                       ///< cached, because most literals share a few datatypes
  std::string_view last_datatype_text;
  explicit Impl(ReadTransaction from);

  ReadTransaction::Impl& state() const { return transaction.impl(); }
  StoreSnapshot& snapshot() const { return snapshotOf(state()); }
  const PageDirectory& directory(QuadOrder order) const { return snapshot().directory(tableOf(order), state()); }
  /// Without comparison with sums; in a write transaction maybe as of the commit before.
  const PageDirectory& pagesForEstimates(QuadOrder order) const {
    const PageDirectory& guarded = directory(order);
    return guarded.guard() ? guarded.guard()->pages() : guarded;
  }
  std::shared_ptr<const std::vector<QuadKey>> collected(const QuadPattern& pattern, QuadOrder order) const;
  std::string_view datatypeText(TermId id);
  std::string_view record(TermId id) const { return snapshot().record(id, state()); }
};

}  // namespace cluxel::rdf
