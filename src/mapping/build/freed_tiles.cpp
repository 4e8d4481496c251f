// SPDX-License-Identifier: Apache-2.0
// A row holds a hash of the gone objects that the tile follows from, and its even ground where that is another than the
// output of the stage.
#include "mapping/build/freed_tiles.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/content_hash.hpp"
#include "base/parallel.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/stored_presence.hpp"
#include "mapping/ways/freed_ground.hpp"
#include "rdf/file/commit_stamps.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

constexpr std::string_view kFreedStamp = "freed ground";
constexpr std::uint32_t kFreedVersion = 1;  ///< of freedGroundOf() and of what it is given
constexpr std::size_t kCauseBytes = sizeof(ContentHash::bytes);
/// With so many tiles in memory the next ones wait.
constexpr std::size_t kTilesAtOnce = 64;

std::vector<std::string> keysOf(const rdf::ReadTransaction& transaction) {
  std::vector<std::string> keys;
  transaction.forEachBlock(tables::kFreed, "", [&](std::string_view key, std::string_view) { keys.emplace_back(key); });
  return keys;
}

/// The gone objects that come near each tile, ascending, and the tiles that they lie in.
struct GoneObjects {
  std::map<TileKey, std::vector<ContentHash>> near;
  std::map<TileKey, std::set<ContentHash>> in;
};

/// The box of what an object has in a tile, relative to the tile's corner [m].
Eigen::AlignedBox2f boxOf(const TileLayer& layer, const ContentHash& object) {
  Eigen::AlignedBox2f box;
  for (const TileLayer::Share& share : layer.shares) {
    if (share.object != object) continue;
    for (const std::uint32_t component : share.components) {
      const Eigen::AlignedBox3f& bounds = layer.primitives.at(component).bounds;
      box.extend(Eigen::AlignedBox2f(bounds.min().head<2>(), bounds.max().head<2>()));
    }
  }
  return box;
}

GoneObjects goneObjectsIn(const rdf::ReadTransaction& transaction) {
  constexpr float kBeyondCluxels_m = 1;  // points lie around the places of cluxels
  constexpr float margin_m = static_cast<float>(perception::kEvenMargin_m) + kBeyondCluxels_m;
  GoneObjects gone;
  for (const ContentHash& id : objectsSeenThrough(transaction))
    if (const auto record = storedRecord(transaction, id))
      for (const TileKey& tile : record->tiles) gone.in[tile].insert(id);
  std::map<TileKey, std::set<ContentHash>> near;
  const Eigen::AlignedBox2f square(Eigen::Vector2f::Constant(-margin_m),
                                   Eigen::Vector2f::Constant(static_cast<float>(perception::kTileSize_m) + margin_m));
  const TileSet all = gone.in.empty() ? TileSet() : storedTiles(transaction);
  for (const auto& [tile, objects] : gone.in) {
    const auto layer = storedLayer(transaction, tile);
    if (!layer) refuseIncompleteTile();
    const auto ring = perception::ringOf(tile);
    for (const ContentHash& object : objects) {
      const Eigen::AlignedBox2f box = boxOf(*layer, object);
      for (std::size_t place = 0; place < ring.size(); ++place) {
        const Eigen::Vector2f shift = perception::ringShift(static_cast<int>(place)).head<2>();
        if (all.contains(ring[place]) && square.translated(shift).intersects(box)) near[ring[place]].insert(object);
      }
    }
  }
  for (const auto& [tile, objects] : near) gone.near[tile].assign(objects.begin(), objects.end());
  return gone;
}

std::string causeOf(const std::vector<ContentHash>& objects) {
  ContentHasher hasher;
  hasher.add(kFreedVersion);
  for (const ContentHash& object : objects) hasher.add(object);
  return tables::keyOf(hasher.finish());
}

class FreedUpdate {
 public:
  FreedUpdate(rdf::WriteTransaction& transaction, const perception::LabelModel& model, const MapParams& params,
              unsigned threads)
      : transaction_(transaction),
        reading_(transaction),
        stages_(model, params),
        threads_(threads),
        all_(storedTiles(transaction)),
        gone_(goneObjectsIn(transaction)) {}

  TileSet run(const TileSet& changed) {
    eraseOthers();
    const TileSet dirty = perception::withRing(changed, all_);
    TileSet wanted, ring;
    for (const auto& [tile, objects] : gone_.near) {
      const auto row = reading_.block(tables::kFreed, tables::keyOf(tile));
      if (row && !dirty.contains(tile) && row->substr(0, kCauseBytes) == causeOf(objects)) continue;
      wanted.insert(tile);
      ring.merge(perception::withRing({tile}, all_));
      if (ring.size() >= kTilesAtOnce) compute(std::exchange(wanted, {}), std::exchange(ring, {}));
    }
    if (!wanted.empty()) compute(wanted, ring);
    return std::move(changed_);
  }

 private:
  void eraseOthers() {
    for (const std::string& key : keysOf(transaction_)) {
      const TileKey tile = tables::tileOfKey(key);
      if (gone_.near.contains(tile)) continue;
      if (freedTile(transaction_, tile)) changed_.insert(tile);
      transaction_.eraseBlock(tables::kFreed, key);
    }
  }

  void compute(const TileSet& wanted, const TileSet& ring) {
    stages_.hold(transaction_, {}, ring);
    stages_.loadPoints(transaction_, ring);
    const std::map<TileKey, GonePoints> gone = gonePoints(ring);
    const std::vector<TileKey> tiles(wanted.begin(), wanted.end());
    std::vector<std::string> even(tiles.size());
    parallelFor(tiles.size(), threads_, [&](std::size_t i) {
      const TileKey& tile = tiles[i];
      even[i] =
          toBytes(freedGroundOf(ringIn(stages_.points(), tile), ringIn(stages_.ground(), tile), ringIn(gone, tile)));
    });
    for (std::size_t i = 0; i < tiles.size(); ++i) store(tiles[i], even[i]);
    stages_.dropAll();
  }

  std::map<TileKey, GonePoints> gonePoints(const TileSet& tiles) const {
    std::map<TileKey, GonePoints> found;
    for (const TileKey& tile : tiles) {
      const auto objects = gone_.in.find(tile);
      if (objects == gone_.in.end()) continue;
      const auto layer = storedLayer(transaction_, tile);
      const perception::CluxelTile& cluxels = stages_.cluxels().at(tile);
      if (!layer || layer->size() != cluxels.size()) refuseIncompleteTile();
      GonePoints& points = found[tile];
      for (const std::uint32_t cluxel : cluxels.point_cluxel) {
        const std::uint32_t share = layer->share_of_cluxel[cluxel];
        const bool is_gone = share != kNoShare && objects->second.contains(layer->shares[share].object);
        points.push_back(is_gone ? 1 : 0);
      }
    }
    return found;
  }

  void store(const TileKey& tile, std::string_view even) {
    if (even == requiredBlock(transaction_, tables::kEven, tile)) even = {};
    if (even != freedTile(transaction_, tile).value_or(std::string_view())) changed_.insert(tile);
    transaction_.putIfDifferent(tables::kFreed, tables::keyOf(tile), causeOf(gone_.near.at(tile)) + std::string(even));
  }

  rdf::WriteTransaction& transaction_;
  const rdf::ReadTransaction& reading_;
  TileStages stages_;
  unsigned threads_;
  TileSet all_;
  GoneObjects gone_;
  TileSet changed_;
};

}  // namespace

bool mayHaveFreedTiles(const rdf::ReadTransaction& transaction) {
  return !objectsSeenThrough(transaction).empty() || !keysOf(transaction).empty();
}

std::optional<std::string_view> freedTile(const rdf::ReadTransaction& transaction, const TileKey& tile) {
  const auto row = transaction.block(tables::kFreed, tables::keyOf(tile));
  if (!row || row->size() <= kCauseBytes) return std::nullopt;
  return row->substr(kCauseBytes);
}

TileSet updateFreedTiles(rdf::WriteTransaction& transaction, const perception::LabelModel& model,
                         const MapParams& params, const TileSet& changed, unsigned threads) {
  TileSet others;
  if (!mayHaveFreedTiles(transaction)) return others;
  if (!rdf::hasStamp(transaction, kFreedStamp)) others = eraseFreedTiles(transaction);
  others.merge(FreedUpdate(transaction, model, params, threads).run(changed));
  rdf::stampCommit(transaction, kFreedStamp);
  return others;
}

void keepFreedTiles(rdf::WriteTransaction& transaction) {
  if (rdf::hasStamp(transaction, kFreedStamp)) rdf::stampCommit(transaction, kFreedStamp);
}

TileSet eraseFreedTiles(rdf::WriteTransaction& transaction) {
  TileSet changed;
  for (const std::string& key : keysOf(transaction)) {
    changed.insert(tables::tileOfKey(key));
    transaction.eraseBlock(tables::kFreed, key);
  }
  return changed;
}

bool copyFreedTiles(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& other, const TileSet& tiles) {
  const std::vector<std::string> keys = keysOf(other);
  if (keys.empty()) return true;
  if (!rdf::hasStamp(other, kFreedStamp)) return false;
  for (const std::string& key : keys)
    if (tiles.contains(tables::tileOfKey(key)))
      transaction.putBlock(tables::kFreed, key, other.block(tables::kFreed, key).value());
  return true;
}

}  // namespace cluxel::mapping
