// SPDX-License-Identifier: Apache-2.0
// Where the map file keeps the outputs of the stages.
#include "mapping/build/tile_stages.hpp"

#include <functional>

#include "base/free_memory.hpp"
#include "mapping/build/scan_bands.hpp"
#include "mapping/build/way_tiles.hpp"
#include "mapping/clouds/recent_scans.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/stored_grid.hpp"

namespace cluxel::mapping {

namespace {

using perception::Stage;
using perception::TileKey;

std::string_view tableOf(Stage stage) {
  static_assert(tables::kStageTables.size() == perception::kStageCount);
  return tables::kStageTables[static_cast<std::size_t>(stage)];
}

/// With more points in memory, these are given up before a window is assembled, which does not read them.
constexpr std::size_t kPointsBeside = 1'000'000;

/// Outputs that are read as another commit has them.
struct EarlierOutputs {
  const rdf::ReadTransaction* transaction = nullptr;
  const TileSet& tiles;
};

/// Reads stored outputs; what is computed from other outputs comes after them.
class OutputReader {
 public:
  OutputReader(const rdf::ReadTransaction& transaction, RecentScans& scans, perception::TileOutputs& outputs,
               const EarlierOutputs* earlier = nullptr)
      : transaction_(transaction), scans_(scans), out_(outputs), earlier_(earlier) {}

  /// Outputs of the stages that other stages read, of the tiles that are not there.
  void read(const TileSet& keys) {
    readPoints(keys);
    each(Stage::Features, keys, out_.features, [&](const TileKey& key, std::string_view bytes) {
      readFeatures(key, bytes, required(out_.cluxels, key).size());
    });
    readLabelled(keys);
  }

  void readPoints(const TileSet& keys) {
    perception::PointsFromScans from_scans(storedGrid(transaction_));
    each(Stage::Points, keys, out_.points, [&](const TileKey& key, std::string_view bytes) {
      from_scans.add(out_.points.emplace(key, ofTile(key, perception::tilePointsFromBytes(bytes))).first->second);
    });
    fill(from_scans);
    each(Stage::Cluxels, keys, out_.cluxels, [&](const TileKey& key, std::string_view bytes) {
      out_.cluxels.emplace(key, ofTile(key, perception::cluxelTileFromBytes(bytes, required(out_.points, key))));
    });
  }

  /// What the scene is assembled from.
  void readForScene(const TileSet& keys) {
    plain(Stage::Summaries, keys, out_.summaries, perception::summaryTileFromBytes);
    each(Stage::Features, keys, out_.features, [&](const TileKey& key, std::string_view bytes) {
      readFeatures(key, bytes, required(out_.summaries, key).size());
    });
    readLabelled(keys);
    plain(Stage::Contacts, keys, out_.contacts, perception::contactTileFromBytes);
  }

  void readGround(const TileSet& keys) { plain(Stage::Ground, keys, out_.ground, perception::groundTileFromBytes); }

 private:
  void readFeatures(const TileKey& key, std::string_view bytes, std::size_t cluxels) {
    out_.features.emplace(key, ofTile(key, perception::featureTileFromBytes(bytes, cluxels)));
  }

  void readLabelled(const TileSet& keys) {
    readGround(keys);
    plain(Stage::Labels, keys, out_.labels, perception::labelTileFromBytes);
    plain(Stage::Components, keys, out_.components, perception::componentTileFromBytes);
  }

  template <typename Tiles, typename Visit>
  void each(Stage stage, const TileSet& keys, const Tiles& tiles, const Visit& visit) {
    for (const TileKey& key : keys) {
      if (tiles.contains(key)) continue;
      const bool is_earlier = earlier_ != nullptr && earlier_->tiles.contains(key);
      const rdf::ReadTransaction& commit = is_earlier ? *earlier_->transaction : transaction_;
      if (const auto block = commit.block(tableOf(stage), tables::keyOf(key)))
        visit(key, perception::hasBorders(stage) ? perception::withoutBorders(*block) : *block);
    }
  }

  template <typename Tiles, typename Decode>
  void plain(Stage stage, const TileSet& keys, Tiles& tiles, const Decode& decode) {
    each(stage, keys, tiles,
         [&](const TileKey& key, std::string_view bytes) { tiles.emplace(key, ofTile(key, decode(bytes))); });
  }

  template <typename Tiles>
  static const typename Tiles::mapped_type& required(const Tiles& tiles, const TileKey& key) {
    if (const auto found = tiles.find(key); found != tiles.end()) return found->second;
    refuseIncompleteTile();
  }

  void fill(const perception::PointsFromScans& tiles) {
    for (const scan::ScanId& id : tiles.scans()) {
      if (!storedCloud(transaction_, id))
        refuseDamaged("a stored tile names scan " + id.hex() + ", which is not there");
      tiles.fill(scans_.scan(id));
    }
  }

  const rdf::ReadTransaction& transaction_;
  RecentScans& scans_;
  perception::TileOutputs& out_;
  const EarlierOutputs* earlier_;
};

/// Outputs in the tables of one write transaction.
class MapOutputStore final : public perception::OutputStore {
 public:
  MapOutputStore(rdf::WriteTransaction& transaction, RecentScans& scans, OutputChanges& changes)
      : transaction_(transaction), scans_(scans), tiles_(storedTiles(transaction)), changes_(changes) {}

  TileSet tiles() const override { return tiles_; }

  void load(const TileSet& keys, perception::TileOutputs& outputs) override {
    OutputReader(transaction_, scans_, outputs).read(keys);
  }

  perception::OutputChange store(Stage stage, const TileKey& key, std::string_view bytes) override {
    const std::string block_key = tables::keyOf(key);
    if (stage == Stage::Points) tiles_.insert(key);
    const auto old = transaction_.block(tableOf(stage), block_key);
    const perception::OutputChange change =
        old ? perception::changeOf(stage, *old, bytes) : perception::kOtherEverywhere;
    if (!change.is_other) return change;
    note(stage, key, old);
    transaction_.putBlock(tableOf(stage), block_key, bytes);
    if (stage == Stage::Even) changed_even_.insert(key);
    return change;
  }

  void erase(Stage stage, const TileKey& key) override {
    if (stage == Stage::Points) tiles_.erase(key);
    note(stage, key, transaction_.block(tableOf(stage), tables::keyOf(key)));
    if (stage == Stage::Even) changed_even_.insert(key);
    transaction_.eraseBlock(tableOf(stage), tables::keyOf(key));
  }

  /// Tiles of which the even ground changed, came or went.
  const TileSet& changedEven() const { return changed_even_; }

 private:
  void note(Stage stage, const TileKey& key, const std::optional<std::string_view>& old) {
    changes_.tiles.insert(key);
    if (stage == Stage::Summaries)
      changes_.former_summaries.try_emplace(key, old ? std::optional(std::string(*old)) : std::nullopt);
  }

  rdf::WriteTransaction& transaction_;
  RecentScans& scans_;
  TileSet tiles_, changed_even_;
  OutputChanges& changes_;
};

/// Outputs that another map has stored. Its scans were copied: they are read together with those of the map.
class OtherMap final : public perception::OutputDonor {
 public:
  OtherMap(const rdf::ReadTransaction& transaction, RecentScans& scans)
      : transaction_(transaction), scans_(scans), tiles_(storedTiles(transaction)) {}

  const TileSet& tiles() const override { return tiles_; }
  std::string_view bytes(Stage stage, const TileKey& key) const override {
    return requiredBlock(transaction_, tableOf(stage), key);
  }
  void load(const TileSet& keys, perception::TileOutputs& outputs) const override {
    OutputReader(transaction_, scans_, outputs).read(keys);
  }

 private:
  const rdf::ReadTransaction& transaction_;
  RecentScans& scans_;
  TileSet tiles_;
};

/// Those of tiles for which `is_other` holds, of all stages but ways.
void giveUp(perception::TileOutputs& outputs, const std::function<bool(const TileKey&)>& is_other) {
  const auto eraseOf = [&](auto& of_stage) {
    std::erase_if(of_stage, [&](const auto& entry) { return is_other(entry.first); });
  };
  eraseOf(outputs.points), eraseOf(outputs.cluxels), eraseOf(outputs.summaries), eraseOf(outputs.ground);
  eraseOf(outputs.features), eraseOf(outputs.labels), eraseOf(outputs.components), eraseOf(outputs.contacts);
}

using PointCounts = std::map<TileKey, std::uint64_t>;

std::uint64_t sumOf(const PointCounts& counts) {
  std::uint64_t sum = 0;
  for (const auto& [tile, count] : counts) sum += count;
  return sum;
}

/// About how many points the tiles have in the map; none for new ones.
PointCounts pointsIn(const rdf::ReadTransaction& transaction, const TileSet& tiles) {
  constexpr std::uint64_t kPointsOfCluxel = 12;  // generated campuses: 6.3 million points, 523 thousand cluxels
  PointCounts points;
  for (const TileKey& tile : tiles)
    if (const auto block = transaction.block(tables::kSummaries, tables::keyOf(tile)))
      points.emplace(tile, kPointsOfCluxel * perception::cluxelsIn(*block));
  return points;
}

class StageProgress final : public perception::StageObserver {
 public:
  explicit StageProgress(ProgressSink& sink) : sink_(sink) {}
  void progress(Stage stage, std::size_t done, std::size_t total) override {
    sink_.progress(nameOf(stage), done, total);
  }

 private:
  ProgressSink& sink_;
};

}  // namespace

TileSet TileStages::update(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads,
                           ProgressSink& sink) {
  return run(transaction, std::move(changes), threads, false, sink);
}

TileSet TileStages::computeAnew(rdf::WriteTransaction& transaction, TileSet tiles, unsigned threads,
                                ProgressSink& sink) {
  PointChanges changes;
  changes.anew = std::move(tiles);
  return run(transaction, std::move(changes), threads, true, sink);
}

TileSet TileStages::run(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads, bool compute_anew,
                        ProgressSink& sink) {
  outputs_.grid = storedGrid(transaction);
  RecentScans scans(transaction);
  MapOutputStore store(transaction, scans, changes_);
  StageProgress progress(sink);
  std::optional<OtherMap> donor;
  if (changes.copied != nullptr) {
    donor.emplace(*changes.copied, scans);
    changes_.has_copied_map = true;
  }
  if (donor || changes.hasAdded() || !changes.anew.empty())
    changes_.lender = changes.is_lender && changes_.tiles.empty() ? changes.copied : nullptr;
  const std::uint64_t anew_points = sumOf(pointsIn(transaction, changes.anew)) + sumOf(changes.stored_points);
  const bool are_many = !donor && !changes.anew.empty() && anew_points > max_points_ + max_points_ / 2;
  // The scans are stored already, also those that were added.
  are_many ? changes.noteAnew(transaction) : changes.readAnew(transaction);
  const perception::RunOptions options{.threads = threads,
                                       .store = &store,
                                       .observer = &progress,
                                       .anew = changes.anew,
                                       .compute_anew = compute_anew,
                                       .donor = donor ? &*donor : nullptr};
  const PointCounts points_there =
      pointsIn(transaction, are_many ? changes.tiles() : without(changes.tiles(), changes.anew));
  TileSet changed;
  if (changes.stored.empty() && !are_many && (donor || sumOf(points_there) < max_points_)) {
    changed = runStages(std::move(changes.added), labeller_, params_, outputs_, options);
  } else {
    ScanBands bands(transaction, std::move(changes), points_there, max_points_ / 2, threads);
    changed = runStages(bands, labeller_, params_, outputs_, options);
  }
  storeTiles(transaction, store.tiles());
  changed_even_.insert(store.changedEven().begin(), store.changedEven().end());
  changed_outputs_.insert(changes_.tiles.begin(), changes_.tiles.end());
  even_ = std::exchange(outputs_.even, {});  // what is missing is read
  return changed;
}

bool TileStages::updateWays(rdf::WriteTransaction& transaction, unsigned threads) {
  return !updateWayTiles(transaction, std::exchange(changed_even_, {}), std::exchange(even_, {}), threads).empty();
}

void TileStages::noteEven(const TileSet& kept, const TileSet& changed) {
  changed_even_ = unionOf(without(std::move(changed_even_), kept), changed);
}

void TileStages::readAsBefore(const rdf::ReadTransaction* earlier, TileSet tiles) {
  giveUp(outputs_, [&](const TileKey& tile) { return tiles.contains(tile) != read_as_before_.contains(tile); });
  earlier_ = earlier, read_as_before_ = std::move(tiles);
}

void TileStages::load(const rdf::ReadTransaction& transaction) {
  outputs_.grid = storedGrid(transaction);
  RecentScans scans(transaction);
  OutputReader(transaction, scans, outputs_).readForScene(storedTiles(transaction));
}

void TileStages::hold(const rdf::ReadTransaction& transaction, const TileSet& tiles, const TileSet& around) {
  giveUp(outputs_, [&](const TileKey& tile) { return !tiles.contains(tile); });
  std::size_t points = 0;
  for (const auto& [key, tile] : outputs_.points) points += tile.size();
  if (points > kPointsBeside) dropPoints(), returnFreeMemory();
  outputs_.grid = storedGrid(transaction);
  RecentScans scans(transaction);
  const EarlierOutputs earlier{earlier_, read_as_before_};
  OutputReader reader(transaction, scans, outputs_, &earlier);
  reader.readForScene(tiles);
  reader.readGround(around);
}

void TileStages::loadPoints(const rdf::ReadTransaction& transaction) {
  loadPoints(transaction, storedTiles(transaction));
}
void TileStages::loadPoints(const rdf::ReadTransaction& transaction, const TileSet& tiles) {
  RecentScans scans(transaction);
  const EarlierOutputs earlier{earlier_, read_as_before_};
  OutputReader(transaction, scans, outputs_, &earlier).readPoints(tiles);
}

perception::Scene TileStages::takeScene(const std::vector<Cloud>& clouds) {
  perception::Scene assembled = scene(clouds);
  if (keep_ == Keep::Summaries) {
    perception::TileOutputs kept;
    kept.grid = outputs_.grid;
    kept.summaries = std::move(outputs_.summaries);
    outputs_ = std::move(kept);
  }
  return assembled;
}

void TileStages::dropPoints() {
  outputs_.points.clear();
  outputs_.cluxels.clear();
}

bool haveSameOutput(const rdf::ReadTransaction& a, const rdf::ReadTransaction& b, Stage stage, const TileKey& tile) {
  const std::string key = tables::keyOf(tile);
  return a.block(tableOf(stage), key) == b.block(tableOf(stage), key);
}

bool haveSameOutputs(const rdf::ReadTransaction& a, const rdf::ReadTransaction& b, const TileKey& tile) {
  for (std::size_t stage = 0; stage < perception::kStageCount; ++stage)
    if (!haveSameOutput(a, b, static_cast<Stage>(stage), tile)) return false;
  return true;
}

}  // namespace cluxel::mapping
