// SPDX-License-Identifier: Apache-2.0
// Only what differs is written.
#include "mapping/presence/object_rows.hpp"

#include <algorithm>

#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

void putRow(rdf::WriteTransaction& transaction, std::string_view table, const ContentHash& object,
            std::string_view bytes) {
  const std::string key = tables::keyOf(object);
  if (const auto old = transaction.block(table, key); old && *old == bytes) return;
  transaction.putBlock(table, key, bytes);
}

void eraseRowsBut(rdf::WriteTransaction& transaction, std::string_view table, std::vector<ContentHash> kept) {
  std::sort(kept.begin(), kept.end());
  std::vector<std::string> gone;
  transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view) {
    if (!std::binary_search(kept.begin(), kept.end(), tables::hashOfKey(key))) gone.emplace_back(key);
  });
  for (const std::string& key : gone) transaction.eraseBlock(table, key);
}

}  // namespace cluxel::mapping
