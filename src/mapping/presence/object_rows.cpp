// SPDX-License-Identifier: Apache-2.0
// Only what differs is written.
#include "mapping/presence/object_rows.hpp"

#include <algorithm>

#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

void putRow(rdf::WriteTransaction& transaction, std::string_view table, const ContentHash& object,
            std::string_view bytes) {
  transaction.putIfDifferent(table, tables::keyOf(object), bytes);
}

void copyRows(rdf::WriteTransaction& transaction, std::string_view table, const rdf::ReadTransaction& other) {
  other.forEachBlock(table, "", [&](std::string_view key, std::string_view bytes) {
    if (!transaction.block(table, key)) transaction.putBlock(table, key, bytes);
  });
}

namespace {

template <typename Stays>
void eraseRows(rdf::WriteTransaction& transaction, std::string_view table, const Stays& stays) {
  std::vector<std::string> gone;
  transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view) {
    if (!stays(key)) gone.emplace_back(key);
  });
  for (const std::string& key : gone) transaction.eraseBlock(table, key);
}

}  // namespace

void eraseRowsBut(rdf::WriteTransaction& transaction, std::string_view table, std::vector<ContentHash> kept) {
  std::sort(kept.begin(), kept.end());
  eraseRows(transaction, table,
            [&](std::string_view key) { return std::binary_search(kept.begin(), kept.end(), tables::hashOfKey(key)); });
}

void eraseRowsWithoutObject(rdf::WriteTransaction& transaction) {
  const auto has_object = [&](std::string_view key) {
    return storedRecord(transaction, tables::hashOfKey(key)).has_value();
  };
  for (const std::string_view table : {tables::kPresence, tables::kPassedRays})
    eraseRows(transaction, table, has_object);
}

}  // namespace cluxel::mapping
