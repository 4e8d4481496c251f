// SPDX-License-Identifier: Apache-2.0
// A map that grows by one strip after the other ends as the map of all of its tiles: each strip is decided as a change.
#include "mapping/strips/whole_update.hpp"

#include <algorithm>
#include <set>

#include "base/free_memory.hpp"
#include "mapping/build/way_telling.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_state.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/splits_store.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/strips/map_strips.hpp"
#include "mapping/window/former_objects.hpp"
#include "mapping/window/map_window.hpp"
#include "mapping/window/window_presence.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/decide/local_reach.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

void eraseAll(rdf::WriteTransaction& transaction, std::string_view table) {
  std::vector<std::string> keys;
  transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view) { keys.emplace_back(key); });
  for (const std::string& key : keys) transaction.eraseBlock(table, key);
}

class StripUpdate {
 public:
  StripUpdate(const LayerWork& work, SemanticState former, std::uint64_t cluxels)
      : work_(work),
        transaction_(work.transaction),
        former_(std::move(former)),
        cluxels_(cluxels),
        all_(storedTiles(work.transaction)) {
    params_.max_window_share = kNoWindowLimit;
  }

  /// Absent when a strip cannot be decided alone. Then former and new layers are mixed; a run over the whole map
  /// replaces both.
  std::optional<SemanticUpdate> run() {
    SemanticUpdate update;
    rules::KnownSplits splits = storedSplits(transaction_);
    LaterTargets made;
    MapStrip strip;
    strip.splits = &splits, strip.later = &made;
    begin(strip);
    for (const TileSet& tiles : strips()) {
      if (work_.check) work_.check(0);
      show(tiles, strip);
      OutputChanges changes;
      changes.tiles = strip.anew;
      for (const TileKey& tile : tiles) changes.former_summaries.emplace(tile, std::nullopt);
      const LayerWork work{work_.transaction, work_.parsed, work_.stages, params_, work_.sink, work_.check};
      const auto decided = updateAround(work, changes, ChangedInputs::Scans, nullptr, &strip);
      if (!decided) return std::nullopt;
      update.tiles_decided += decided->tiles_decided;
      update.objects = decided->objects, update.cluxels = decided->cluxels, update.primitives = decided->primitives;
      for (const TileKey& tile : tiles) notePrimitives(tile);
      strip.retired = {}, strip.told_clouds = seenClouds(storedClouds(transaction_));
      transaction_.writePages();
      returnFreeMemory();
    }
    const auto is_there = [&](const ContentHash& id) {
      const auto record = storedRecord(transaction_, id);
      return record && !record->tiles.empty();
    };
    if (!std::all_of(strip.wide.begin(), strip.wide.end(), is_there)) return std::nullopt;  // else its facts stay
    if (work_.check) work_.check(0);
    tellPresence(transaction_, made.take(), storedClouds(transaction_), made.removed(), params_.threads);
    eraseRowsWithoutObject(transaction_);
    tellWaysWithoutGone(transaction_, work_.parsed, work_.stages, params_.threads);
    transaction_.writePages();
    returnFreeMemory();
    update.whole_rules = inferFacts(transaction_, work_.parsed.inputs, work_.sink, work_.check);
    storeSplits(transaction_, splits);
    update.statements = toldOutcomes(rdf::QuadReader(reading()));
    return update;
  }

 private:
  const rdf::ReadTransaction& reading() const { return transaction_; }

  std::vector<TileSet> strips() const {
    return layerStripsOf(transaction_, all_, cluxels_, work_.params.whole_cluxels);
  }

  /// Nothing of the map counts any more. Layers and rows stay where they are until they are written anew, because most
  /// will be the same.
  void begin(MapStrip& strip) {
    strip.told_clouds = former_.clouds;
    storeSemanticState(transaction_, {0, 0, 0, former_.statements, seenClouds(storedClouds(transaction_))});
    for (const std::string_view table : {tables::kOverruled, tables::kStated}) eraseAll(transaction_, table);
    forEachRecord(transaction_, [&](const ContentHash& id, const ObjectRecord& record) {
      if (record.is_class_wide) strip.wide.insert(id);
    });
    for (const ContentHash& id : strip.wide) transaction_.eraseBlock(tables::kObjects, tables::keyOf(id));
    retireTilesThatAreGone(strip);
  }

  void retireTilesThatAreGone(MapStrip& strip) {
    std::vector<TileKey> gone;
    forEachStoredLayer(transaction_, [&](const TileLayer& layer) {
      if (all_.contains(layer.key)) return;
      gone.push_back(layer.key);
      retire(layer, strip);
    });
    for (const TileKey& tile : gone)
      for (const std::string_view table : {tables::kTileLayers, tables::kMargins, tables::kWideTiles})
        transaction_.eraseBlock(table, tables::keyOf(tile));
  }

  void show(const TileSet& tiles, MapStrip& strip) {
    for (const TileKey& tile : tiles)
      if (const auto layer = storedLayer(transaction_, tile)) retire(*layer, strip);
    strip.anew = perception::withRing(tiles, perception::unionOf(strip.shown, tiles));
    strip.shown.insert(tiles.begin(), tiles.end());
  }

  /// What has been decided anew under the same name, elsewhere, stays.
  void retire(const TileLayer& layer, MapStrip& strip) const {
    for (const TileLayer::PrimitiveHere& primitive : layer.primitives)
      if (!primitives_.contains(primitive.id)) strip.retired.primitives.insert(primitive.id);
    for (const TileLayer::Share& share : layer.shares) {
      if (strip.wide.contains(share.object)) continue;
      const auto record = storedRecord(transaction_, share.object);
      const bool is_anew = record && std::all_of(record->tiles.begin(), record->tiles.end(),
                                                 [&](const TileKey& tile) { return strip.shown.contains(tile); });
      if (!is_anew) strip.retired.objects.insert(share.object);
    }
  }

  void notePrimitives(const TileKey& tile) {
    if (const auto layer = storedLayer(transaction_, tile))
      for (const TileLayer::PrimitiveHere& primitive : layer->primitives) primitives_.insert(primitive.id);
  }

  const LayerWork& work_;
  rdf::WriteTransaction& transaction_;
  SemanticState former_;
  std::uint64_t cluxels_;
  TileSet all_;
  UpdateParams params_ = work_.params;
  std::set<ContentHash> primitives_;  ///< in tiles that are shown
};

bool makesWideObjectsButGround(const rules::RuleSet& rules) {
  return std::any_of(rules.rules.begin(), rules.rules.end(), [](const rules::Rule& rule) {
    return rule.class_iri != rdf::vocabulary::clx("Ground") &&
           std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const rules::TreeNode& node) {
             const auto* accept = std::get_if<rules::AcceptLeaf>(&node.what);
             return accept != nullptr && accept->merge_into == rules::MergeInto::Class;
           });
  });
}

std::optional<SemanticUpdate> updateInStrips(const LayerWork& work) {
  const std::optional<SemanticState> former = storedSemanticState(work.transaction);
  if (!canBeInStrips(work)) return std::nullopt;
  const std::uint64_t cluxels = cluxelsIn(work.transaction, storedTiles(work.transaction), work.stages.summaries());
  if (cluxels <= work.params.whole_cluxels) return std::nullopt;
  if (former) {
    const MapInputs inputs = storedInputs(work.transaction);
    if (inputs.crs != work.parsed.inputs.crs || inputs.map_origin != work.parsed.inputs.map_origin) return std::nullopt;
  } else {
    writeMapFacts(work.transaction, work.parsed.inputs);
  }
  writeOntology(work.transaction, work.parsed.inputs);
  auto update = StripUpdate(work, former.value_or(SemanticState{}), cluxels).run();
  if (update && work.params.lists_objects) update->after = storedMembers(work.transaction);
  if (!update)
    for (const std::string_view table : {tables::kTileLayers, tables::kObjects}) eraseAll(work.transaction, table);
  return update;
}

SemanticUpdate updateAtOnce(const LayerWork& work) {
  work.stages.load(work.transaction);
  SemanticUpdate update;
  update.tiles_decided = storedTiles(work.transaction).size();
  SemanticLayer layer =
      writeSemanticLayer(work.transaction, work.parsed, work.stages, work.params.threads, work.sink, work.check);
  if (work.params.lists_objects) update.after = membersOf(layer.objects, layer.scene.cluxels);
  update.objects = layer.objects.size();
  update.cluxels = layer.scene.cluxels.size(), update.primitives = layer.scene.primitives.size();
  update.statements = std::move(layer.statements), update.whole_rules = std::move(layer.whole_rules);
  storeSemanticState(work.transaction, {update.cluxels, update.primitives, update.objects,
                                        statementIds(work.transaction), seenClouds(storedClouds(work.transaction))});
  return update;
}

}  // namespace

bool canBeInStrips(const LayerWork& work) {
  const std::optional<double> reach_m = rules::localReach(work.parsed.rules).reach_m;
  return reach_m && *reach_m <= perception::kTileSize_m && !makesWideObjectsButGround(work.parsed.rules);
}

SemanticUpdate updateAll(const LayerWork& work, OutputChanges changes) {
  std::vector<ObjectMembers> before;
  if (work.params.lists_objects) {
    const SemanticState former = storedSemanticState(work.transaction).value_or(SemanticState{});
    before = formerObjects(work.transaction, changes,
                           motionsBetween(work.transaction.before(), former.clouds, storedClouds(work.transaction)));
  }
  changes.former_summaries.clear();  // they are large
  std::optional<SemanticUpdate> update = updateInStrips(work);
  if (!update) update = updateAtOnce(work);
  DifferentObjects& different = *update;
  different = differenceOf(std::move(before), std::move(different.after));
  return *std::move(update);
}

std::optional<SemanticUpdate> updateInference(const LayerWork& work, const OutputChanges& changes) {
  const std::optional<SemanticState> state = storedSemanticState(work.transaction);
  if (!state || !changes.tiles.empty() || state->statements != statementIds(work.transaction) ||
      !areSame(state->clouds, seenClouds(storedClouds(work.transaction))))
    return std::nullopt;
  writeOntology(work.transaction, work.parsed.inputs);
  SemanticUpdate update;
  update.whole_rules = inferFacts(work.transaction, work.parsed.inputs, work.sink, work.check);
  keepToldWays(work.transaction);
  update.is_local = true;
  update.objects = state->objects, update.cluxels = state->cluxels, update.primitives = state->primitives;
  if (!state->statements.empty()) {
    const rdf::ReadTransaction& reading = work.transaction;
    update.statements = toldOutcomes(rdf::QuadReader(reading));
  }
  return update;
}

}  // namespace cluxel::mapping
