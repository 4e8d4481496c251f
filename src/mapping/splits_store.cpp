// SPDX-License-Identifier: Apache-2.0
// One block.
#include "mapping/splits_store.hpp"

#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kSplitsKey = "splits";

}  // namespace

void storeSplits(rdf::WriteTransaction& transaction, const rules::KnownSplits& splits) {
  if (splits.count() == 0)
    transaction.eraseBlock(tables::kMeta, kSplitsKey);
  else
    transaction.putBlock(tables::kMeta, kSplitsKey, splits.stored());
}

void copySplits(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& other) {
  const auto bytes = other.block(tables::kMeta, kSplitsKey);
  if (!bytes) return;
  rules::KnownSplits splits = storedSplits(transaction);
  splits.learn(*bytes);
  splits.keepAll();
  storeSplits(transaction, splits);
}

rules::KnownSplits storedSplits(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, kSplitsKey);
  return bytes ? rules::KnownSplits(*bytes) : rules::KnownSplits();
}

rules::KnownSplits storedSplitsIfFew(const rdf::ReadTransaction& transaction) {
  constexpr std::size_t kFew = 4 << 20;  // bytes; a campus of 2.4 million points has 0.4 million
  const auto bytes = transaction.block(tables::kMeta, kSplitsKey);
  return bytes && bytes->size() <= kFew ? rules::KnownSplits(*bytes) : rules::KnownSplits();
}

}  // namespace cluxel::mapping
