// SPDX-License-Identifier: Apache-2.0
// Where the map file keeps the outputs of the stages.
#include "mapping/build/tile_stages.hpp"

#include <array>

#include "mapping/build/scan_store.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using perception::Stage;
using perception::TileKey;

std::string_view tableOf(Stage stage) {
  constexpr std::array<std::string_view, perception::kStageCount> kTables{
      tables::kPoints, tables::kCluxels,    tables::kGround,  tables::kFeatures,
      tables::kLabels, tables::kComponents, tables::kContacts};
  return kTables[static_cast<std::size_t>(stage)];
}

/// Calls `visit(stage, tiles, decoder)` for each stage whose outputs other stages read.
template <typename Visit>
void forEachReadStage(perception::TileOutputs& outputs, const Visit& visit) {
  visit(Stage::Points, outputs.points, perception::tilePointsFromBytes);
  visit(Stage::Cluxels, outputs.cluxels, perception::cluxelTileFromBytes);
  visit(Stage::Ground, outputs.ground, perception::groundTileFromBytes);
  visit(Stage::Features, outputs.features, perception::featureTileFromBytes);
  visit(Stage::Labels, outputs.labels, perception::labelTileFromBytes);
  visit(Stage::Components, outputs.components, perception::componentTileFromBytes);
}

/// Outputs in the tables of one write transaction.
class MapOutputStore final : public perception::OutputStore {
 public:
  explicit MapOutputStore(rdf::WriteTransaction& transaction) : transaction_(transaction) {}

  TileSet tiles() const override { return storedTiles(transaction_); }

  void load(const TileSet& keys, perception::TileOutputs& outputs) override {
    forEachReadStage(outputs, [&](Stage stage, auto& tiles, const auto& decode) {
      for (const TileKey& key : keys) {
        if (tiles.contains(key)) continue;
        if (const auto bytes = transaction_.block(tableOf(stage), tables::keyOf(key)))
          tiles.emplace(key, decode(*bytes));
      }
    });
  }

  bool store(Stage stage, const TileKey& key, std::string_view bytes) override {
    const std::string block_key = tables::keyOf(key);
    if (const auto old = transaction_.block(tableOf(stage), block_key); old && *old == bytes) return false;
    transaction_.putBlock(tableOf(stage), block_key, bytes);
    return true;
  }

  void erase(Stage stage, const TileKey& key) override { transaction_.eraseBlock(tableOf(stage), tables::keyOf(key)); }

 private:
  rdf::WriteTransaction& transaction_;
};

class StageProgress final : public perception::StageObserver {
 public:
  explicit StageProgress(ProgressSink& sink) : sink_(sink) {}
  void progress(Stage stage, std::size_t done, std::size_t total) override {
    sink_.progress(nameOf(stage), done, total);
  }

 private:
  ProgressSink& sink_;
};

perception::TileSegments storedSegments(const rdf::ReadTransaction& transaction, const TileSet& tiles) {
  perception::TileSegments segments;
  for (const TileKey& tile : tiles) {
    auto& of_tile = segments[tile];  // stays empty when the last scan in it was removed
    transaction.forEachBlock(tables::kSegments, tables::keyOf(tile), [&](std::string_view, std::string_view bytes) {
      of_tile.push_back(perception::scanSegmentFromBytes(bytes));
    });
  }
  return segments;
}

}  // namespace

TileSet TileStages::update(rdf::WriteTransaction& transaction, const TileSet& touched, unsigned threads,
                           ProgressSink& sink) {
  return run(transaction, touched, threads, false, sink);
}

TileSet TileStages::updateAll(rdf::WriteTransaction& transaction, unsigned threads, ProgressSink& sink) {
  return run(transaction, storedTiles(transaction), threads, true, sink);
}

TileSet TileStages::run(rdf::WriteTransaction& transaction, const TileSet& touched, unsigned threads, bool compute_all,
                        ProgressSink& sink) {
  MapOutputStore store(transaction);
  StageProgress progress(sink);
  return runStages(storedSegments(transaction, touched), labeller_, params_, outputs_,
                   {.threads = threads, .store = &store, .observer = &progress, .compute_all = compute_all});
}

void TileStages::loadAll(const rdf::ReadTransaction& transaction) {
  const auto load = [&](Stage stage, auto& tiles, const auto& decode) {
    transaction.forEachBlock(tableOf(stage), "", [&](std::string_view key, std::string_view bytes) {
      const TileKey tile = tables::tileOfKey(key);
      if (!tiles.contains(tile)) tiles.emplace(tile, decode(bytes));
    });
  };
  forEachReadStage(outputs_, load);
  load(Stage::Contacts, outputs_.contacts, perception::contactTileFromBytes);
}

}  // namespace cluxel::mapping
