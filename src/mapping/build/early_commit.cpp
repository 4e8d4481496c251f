// SPDX-License-Identifier: Apache-2.0
// Descriptions of scans wait in a table of their own. Points and outputs without a scan or a tile that the map lists
// are read by nobody.
#include "mapping/build/early_commit.hpp"

#include <chrono>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_tables.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

std::vector<std::string> keysOf(const rdf::ReadTransaction& transaction, std::string_view table) {
  std::vector<std::string> keys;
  transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view) { keys.emplace_back(key); });
  return keys;
}

void moveBlocks(rdf::WriteTransaction& transaction, std::string_view from, std::string_view to,
                const std::vector<std::string>& keys) {
  for (const std::string& key : keys)
    if (const auto block = transaction.block(from, key)) {
      const std::string bytes(*block);
      transaction.eraseBlock(from, key);
      transaction.putBlock(to, key, bytes);
    }
}

/// Outputs of tiles that the map had before and has otherwise now, and the list of its tiles. They are as before until
/// they are put back.
class OtherOutputs {
 public:
  OtherOutputs(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& before, const TileSet& tiles)
      : transaction_(transaction) {
    for (const TileKey& tile : tiles)
      for (const std::string_view table : tables::kStageTables) exchange(before, table, tables::keyOf(tile));
    exchange(before, tables::kMeta, std::string(tables::kTilesKey));
  }

  void putBack() {
    for (Output& output : outputs_) {
      put(output.table, output.key, output.now);
      output = {};
    }
  }

 private:
  using Bytes = std::optional<std::string>;
  struct Output {
    std::string_view table;
    std::string key;
    Bytes now;
  };

  void exchange(const rdf::ReadTransaction& before, std::string_view table, const std::string& key) {
    const auto bytes = [&](const rdf::ReadTransaction& commit) {
      const auto block = commit.block(table, key);
      return block ? Bytes(*block) : std::nullopt;
    };
    const Bytes then = bytes(before);
    Bytes now = bytes(transaction_);
    if (now == then) return;
    put(table, key, then);
    outputs_.push_back({table, key, std::move(now)});
  }

  void put(std::string_view table, const std::string& key, const Bytes& bytes) {
    if (bytes)
      transaction_.putBlock(table, key, *bytes);
    else
      transaction_.eraseBlock(table, key);
  }

  rdf::WriteTransaction& transaction_;
  std::vector<Output> outputs_;
};

/// Another program may be writing: waits up to ten minutes.
rdf::WriteTransaction beginWhenFree(const BeginBatch& begin) {
  constexpr auto kPatience = std::chrono::minutes(10);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    try {
      return begin();
    } catch (const rdf::MapBusy&) {
      if (std::chrono::steady_clock::now() >= deadline) throw;
    }
  }
}

}  // namespace

void commitPoints(std::span<const scan::ScanId> scans, rdf::WriteTransaction& transaction, const BeginBatch& begin) {
  std::vector<std::string> keys;
  for (const scan::ScanId& scan : scans) keys.push_back(tables::keyOf(scan));
  moveBlocks(transaction, tables::kScans, tables::kScansToCome, keys);
  // Freed tiles and facts about ways lose their stamps here on purpose. After a kill the outputs of new tiles are
  // stored already, and the next change finds them equal. The lost stamp alone then makes the freed tiles beside them
  // follow.
  transaction.commit();
  transaction = beginWhenFree(begin);
  moveBlocks(transaction, tables::kScansToCome, tables::kScans, keys);
}

void commitOutputs(std::span<const scan::ScanId> scans, const TileSet& changed, rdf::WriteTransaction& transaction,
                   const BeginBatch& begin) {
  std::optional<rdf::ReadTransaction> before = transaction.before();
  const TileSet tiles_before = storedTiles(*before);
  TileSet known = changed;
  std::erase_if(known, [&](const TileKey& tile) { return !tiles_before.contains(tile); });
  if (2 * known.size() > changed.size()) return;  // more would be put back than committed
  OtherOutputs others(transaction, *before, known);
  before.reset();
  commitPoints(scans, transaction, begin);
  others.putBack();
}

bool hasEarlyCommit(const rdf::ReadTransaction& transaction) {
  return !keysOf(transaction, tables::kScansToCome).empty();
}

void eraseEarlyCommit(rdf::WriteTransaction& transaction) {
  const std::vector<std::string> scans = keysOf(transaction, tables::kScansToCome);
  if (scans.empty()) return;
  for (const std::string& key : scans) {
    transaction.eraseBlock(tables::kScansToCome, key);
    if (!transaction.block(tables::kScans, key)) transaction.eraseBlock(tables::kScanPoints, key);
  }
  const TileSet tiles = storedTiles(transaction);
  for (const std::string_view table : tables::kStageTables)
    for (const std::string& key : keysOf(transaction, table))
      if (!tiles.contains(tables::tileOfKey(key))) transaction.eraseBlock(table, key);
}

void dropEarlyCommit(const BeginBatch& begin, ProgressSink& sink) {
  try {
    rdf::WriteTransaction transaction = begin();
    if (!hasEarlyCommit(transaction)) return;
    eraseEarlyCommit(transaction);
    transaction.commit();
  } catch (const std::exception& error) {
    sink.note(std::string("unfinished data of this command stay in the file until the next change removes them: ") +
              error.what());
  }
}

}  // namespace cluxel::mapping
