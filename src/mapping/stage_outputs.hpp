// SPDX-License-Identifier: Apache-2.0
// The stored outputs of one stage: decoded when read, compared when written, so that an equal output stops the change.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/base/parallel.hpp"
#include "cluxel/base/progress.hpp"
#include "cluxel/knowledge/environment.hpp"
#include "cluxel/perception/tile.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel {

using TileSet = std::set<TileKey>;

/// The tiles and their neighbours, as far as they are in `existing`.
inline TileSet withRing(const TileSet& tiles, const TileSet& existing) {
  TileSet all;
  for (const TileKey& tile : tiles)
    for (const TileKey& near : ringOf(tile))
      if (existing.contains(near)) all.insert(near);
  return all;
}

inline TileSet unionOf(TileSet a, const TileSet& b) {
  a.insert(b.begin(), b.end());
  return a;
}

template <typename Tile>
class StageOutputs {
 public:
  using Decoder = Tile (*)(std::string_view);
  StageOutputs(std::string_view table, Decoder decode) : table_(table), decode_(decode) {}

  /// Decoded tiles; holds what load() and recompute() brought in.
  const std::map<TileKey, Tile>& tiles() const { return tiles_; }
  const Tile& at(const TileKey& key) const { return tiles_.at(key); }
  Ring<Tile> ring(const TileKey& key) const { return ringIn(tiles_, key); }

  void load(const ReadTransaction& transaction, const TileSet& keys) {
    for (const TileKey& key : keys) {
      if (tiles_.contains(key)) continue;
      if (const auto bytes = transaction.block(table_, tables::keyOf(key))) tiles_.emplace(key, decode_(*bytes));
    }
  }

  void loadAll(const ReadTransaction& transaction) {
    transaction.forEachBlock(table_, "", [&](std::string_view key, std::string_view bytes) {
      const TileKey tile = tables::tileOfKey(key);
      if (!tiles_.contains(tile)) tiles_.emplace(tile, decode_(bytes));
    });
  }

  /// Computes the outputs of `dirty`, stores those that differ, and returns their tiles.
  template <typename Compute>
  TileSet recompute(WriteTransaction& transaction, const TileSet& dirty, unsigned threads, ProgressSink& sink,
                    const Compute& compute) {
    constexpr std::size_t kChunk = 64;
    const std::vector<TileKey> keys(dirty.begin(), dirty.end());
    TileSet changed;
    for (std::size_t first = 0; first < keys.size(); first += kChunk) {
      const std::size_t count = std::min(kChunk, keys.size() - first);
      std::vector<Tile> outputs(count);
      std::vector<std::string> bytes(count);
      parallelFor(count, threads, [&](std::size_t i) {
        outputs[i] = compute(keys[first + i]);
        bytes[i] = toBytes(outputs[i]);
      });
      for (std::size_t i = 0; i < count; ++i)
        if (store(transaction, keys[first + i], std::move(outputs[i]), bytes[i])) changed.insert(keys[first + i]);
      sink.progress(table_.substr(6), first + count, keys.size());
    }
    return changed;
  }

 private:
  bool store(WriteTransaction& transaction, const TileKey& key, Tile output, const std::string& bytes) {
    const std::string block_key = tables::keyOf(key);
    tiles_.insert_or_assign(key, std::move(output));
    if (const auto old = transaction.block(table_, block_key); old && *old == bytes) return false;
    transaction.putBlock(table_, block_key, bytes);
    return true;
  }

  std::string table_;
  Decoder decode_;
  std::map<TileKey, Tile> tiles_;
};

}  // namespace cluxel
