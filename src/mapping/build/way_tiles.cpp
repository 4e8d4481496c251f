// SPDX-License-Identifier: Apache-2.0
// Tiles are computed in blocks of neighbours, each with the ring around it.
#include "mapping/build/way_tiles.hpp"

#include <map>

#include "base/parallel.hpp"
#include "mapping/build/freed_tiles.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/stored_grid.hpp"
#include "mapping/ways/way_stage.hpp"

namespace cluxel::mapping {

namespace {

using perception::EvenTile;
using perception::TileKey;
using Bytes = std::map<TileKey, std::string>;

/// Consecutive tiles, in as many sets as there are threads.
std::vector<TileSet> sharesOf(const TileSet& tiles, std::size_t threads) {
  constexpr std::size_t least_tiles = 16;
  const std::size_t shares = std::max<std::size_t>(1, std::min(threads, tiles.size() / least_tiles));
  std::vector<TileSet> list(shares);
  std::size_t number = 0;
  for (const TileKey& tile : tiles) list[number++ * shares / tiles.size()].insert(tile);
  return list;
}

/// Sets of tiles that lie near each other, of bounded size.
std::vector<TileSet> blocksOf(const TileSet& tiles, std::size_t threads) {
  constexpr std::int32_t edge = 16;
  if (tiles.size() <= static_cast<std::size_t>(edge) * edge) return sharesOf(tiles, threads);
  const auto whole = [](std::int32_t at) { return at < 0 ? (at + 1) / edge - 1 : at / edge; };
  std::map<TileKey, TileSet> blocks;
  for (const TileKey& tile : tiles) blocks[{whole(tile.x), whole(tile.y)}].insert(tile);
  std::vector<TileSet> list;
  for (auto& [key, block] : blocks) list.push_back(std::move(block));
  return list;
}

/// What one thread reads. Views into a transaction are valid until its next write.
struct BlockInputs {
  TileSet wanted, context;
  std::map<TileKey, std::string_view> even, surfaces;
};

/// One run of the two stages.
class WayUpdate {
 public:
  WayUpdate(rdf::WriteTransaction& transaction, const std::map<TileKey, EvenTile>& fresh, unsigned threads)
      : transaction_(transaction), fresh_(fresh), threads_(std::max(1U, threads)), all_(storedTiles(transaction)) {}

  TileSet run(const TileSet& changed_even) {
    TileSet changed, surfaces, ways;
    for (const TileKey& tile : changed_even)
      if (!all_.contains(tile)) erase(tile, changed);
    addIncomplete(surfaces, ways);
    surfaces.merge(withRing(changed_even, all_));
    const TileSet changed_surfaces = update(tables::kSurfaces, surfaces, [this](const BlockInputs& inputs) {
      Bytes found;
      for (const auto& [key, tile] : surfaceTilesOf(inputs.wanted, inputs.context, evenIn(inputs)))
        found.emplace(key, surfaceBytes(key, tile));
      return found;
    });
    ways.merge(withRing(unionOf(changed_surfaces, changed_even), all_));
    changed.merge(update(tables::kWays, ways, [this](const BlockInputs& inputs) {
      const auto surface_at = [&](const TileKey& key) { return surfaceTileFromBytes(inputs.surfaces.at(key), key); };
      Bytes found;
      for (const auto& [key, tile] : wayTilesOf(inputs.wanted, inputs.context, evenIn(inputs), surface_at))
        found.emplace(key, toBytes(tile));
      return found;
    }));
    return changed;
  }

 private:
  void erase(const TileKey& tile, TileSet& changed) {
    transaction_.eraseBlock(tables::kSurfaces, tables::keyOf(tile));
    if (transaction_.eraseBlock(tables::kWays, tables::keyOf(tile))) changed.insert(tile);
  }

  void addIncomplete(TileSet& surfaces, TileSet& ways) const {
    for (const TileKey& tile : all_) {
      if (!transaction_.block(tables::kSurfaces, tables::keyOf(tile))) surfaces.insert(tile);
      if (!transaction_.block(tables::kWays, tables::keyOf(tile))) ways.insert(tile);
    }
  }

  BlockInputs inputsOf(const TileSet& block, bool with_surfaces) const {
    BlockInputs inputs{block, withRing(block, all_), {}, {}};
    for (const TileKey& key : inputs.context) {
      if (const auto freed = freedTile(transaction_, key))
        inputs.even.emplace(key, *freed);
      else if (!fresh_.contains(key))
        inputs.even.emplace(key, requiredBlock(transaction_, tables::kEven, key));
      if (with_surfaces) inputs.surfaces.emplace(key, requiredBlock(transaction_, tables::kSurfaces, key));
    }
    return inputs;
  }

  EvenTileSource evenIn(const BlockInputs& inputs) const {
    return [this, &inputs](const TileKey& key) {
      if (const auto found = inputs.even.find(key); found != inputs.even.end())
        return ofTile(key, perception::evenTileFromBytes(found->second));
      return fresh_.at(key);
    };
  }

  /// Computes and stores one stage of some tiles. Returns those of which the bytes changed.
  template <typename Compute>
  TileSet update(std::string_view table, const TileSet& tiles, const Compute& compute) {
    TileSet changed;
    if (tiles.empty()) return changed;
    const std::vector<TileSet> blocks = blocksOf(tiles, threads_);
    for (std::size_t begin = 0; begin < blocks.size(); begin += threads_) {
      const std::size_t count = std::min<std::size_t>(threads_, blocks.size() - begin);
      std::vector<BlockInputs> inputs;
      for (std::size_t i = 0; i < count; ++i) inputs.push_back(inputsOf(blocks[begin + i], table == tables::kWays));
      std::vector<Bytes> found(count);
      parallelFor(count, threads_, [&](std::size_t i) { found[i] = compute(inputs[i]); });
      for (const Bytes& outputs : found) store(table, outputs, changed);
    }
    return changed;
  }

  void store(std::string_view table, const Bytes& outputs, TileSet& changed) {
    for (const auto& [tile, bytes] : outputs) {
      if (transaction_.putIfDifferent(table, tables::keyOf(tile), bytes)) changed.insert(tile);
    }
  }

  rdf::WriteTransaction& transaction_;
  const std::map<TileKey, EvenTile>& fresh_;
  unsigned threads_;
  TileSet all_;
};

}  // namespace

TileSet updateWayTiles(rdf::WriteTransaction& transaction, const TileSet& changed_even,
                       const std::map<TileKey, EvenTile>& fresh, unsigned threads) {
  return WayUpdate(transaction, fresh, threads).run(changed_even);
}

WayGraph storedWays(const rdf::ReadTransaction& transaction) {
  std::vector<WayTile> tiles;
  for (const TileKey& key : storedTiles(transaction))
    tiles.push_back(ofTile(key, wayTileFromBytes(requiredBlock(transaction, tables::kWays, key))));
  return mergedWays(tiles, storedGrid(transaction));
}

WayGraph measuredWays(const rdf::ReadTransaction& transaction) {
  const auto tileAt = [&](const TileKey& key) {
    return ofTile(key, perception::evenTileFromBytes(requiredBlock(transaction, tables::kEven, key)));
  };
  return waysOf(storedTiles(transaction), tileAt, storedGrid(transaction));
}

}  // namespace cluxel::mapping
