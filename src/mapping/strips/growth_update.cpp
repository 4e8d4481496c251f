// SPDX-License-Identifier: Apache-2.0
// What changed in tiles that were there is decided with the first strip of new tiles.
#include "mapping/strips/growth_update.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/free_memory.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/strips/map_strips.hpp"
#include "mapping/strips/whole_update.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

class GrowthUpdate {
 public:
  GrowthUpdate(const LayerWork& work, const OutputChanges& changes, const SemanticState& former)
      : work_(work), transaction_(work.transaction), changes_(changes), all_(storedTiles(work.transaction)) {
    params_.max_window_share = 2;  // a window never gives way to the whole map
    for (const auto& [tile, summary] : changes.former_summaries)
      if (!summary && all_.contains(tile)) new_.insert(tile);
    const std::uint64_t tiles_before = std::max<std::uint64_t>(1, all_.size() - new_.size());
    new_cluxels_ = former.cluxels * new_.size() / tiles_before;
    strip_.told_clouds = former.clouds;
  }

  bool isLarge() const { return !new_.empty() && new_cluxels_ > params_.whole_cluxels; }

  std::optional<SemanticUpdate> run() {
    const std::vector<ContentHash> wide = wideObjects();
    strip_.shown = without(all_, new_);
    strip_.keeps_lists = true;
    SemanticUpdate update;
    bool is_first = true;
    for (const TileSet& tiles : layerStripsOf(transaction_, new_, new_cluxels_, params_.whole_cluxels)) {
      if (work_.check) work_.check(0);
      auto decided = decide(tiles, is_first);
      if (!decided && is_first) return std::nullopt;
      if (!decided) return decideRest();
      is_first = false;
      update.tiles_decided += decided->tiles_decided;
      update.objects = decided->objects, update.cluxels = decided->cluxels, update.primitives = decided->primitives;
      difference_.add(std::move(decided->before), std::move(decided->after));
      strip_.told_clouds = seenClouds(storedClouds(transaction_));
      returnFreeMemory();
    }
    if (!std::all_of(wide.begin(), wide.end(), [&](const ContentHash& id) { return isThere(id); })) return decideRest();
    inferFacts(transaction_, work_.parsed.inputs, work_.sink, work_.check);
    const rdf::ReadTransaction& reading = transaction_;
    update.statements = toldOutcomes(rdf::QuadReader(reading));
    update.is_local = true;
    return withLists(std::move(update));
  }

 private:
  std::optional<SemanticUpdate> decide(const TileSet& tiles, bool is_first) {
    strip_.shown.insert(tiles.begin(), tiles.end());
    strip_.anew = perception::withRing(tiles, strip_.shown);
    OutputChanges changes;
    changes.tiles = strip_.anew;
    for (const TileKey& tile : tiles) changes.former_summaries.emplace(tile, std::nullopt);
    if (is_first) {
      for (const TileKey& tile : changes_.tiles)
        if (!new_.contains(tile)) changes.tiles.insert(tile);
      for (const auto& [tile, summary] : changes_.former_summaries)
        if (!new_.contains(tile)) changes.former_summaries.emplace(tile, summary);
    }
    const LayerWork work{work_.transaction, work_.parsed, work_.stages, params_, work_.sink, work_.check};
    auto decided = updateAround(work, changes, ChangedInputs::Scans, nullptr, &strip_);
    if (!decided) return std::nullopt;
    for (const TileKey& tile : tiles) new_.erase(tile);
    return decided;
  }

  /// A strip cannot be decided alone: the whole map is.
  SemanticUpdate decideRest() {
    OutputChanges rest;
    rest.tiles = new_;
    for (const TileKey& tile : new_) rest.former_summaries.emplace(tile, std::nullopt);
    SemanticUpdate update = updateAll(work_, rest);
    difference_.add(std::exchange(update.before, {}), std::exchange(update.after, {}));
    return withLists(std::move(update));
  }

  SemanticUpdate withLists(SemanticUpdate update) {
    std::tie(update.before, update.after) = std::move(difference_).take();
    return update;
  }

  std::vector<ContentHash> wideObjects() const {
    std::vector<ContentHash> wide;
    forEachRecord(transaction_, [&](const ContentHash& id, const ObjectRecord& record) {
      if (record.is_class_wide) wide.push_back(id);
    });
    return wide;
  }
  bool isThere(const ContentHash& id) const {
    const auto record = storedRecord(transaction_, id);
    return record && !record->tiles.empty();
  }

  const LayerWork& work_;
  rdf::WriteTransaction& transaction_;
  const OutputChanges& changes_;
  TileSet all_, new_;  ///< of the map, and those that are not shown yet
  std::uint64_t new_cluxels_ = 0;
  UpdateParams params_ = work_.params;
  MapStrip strip_;
  ObjectDifference difference_;
};

}  // namespace

std::optional<SemanticUpdate> updateByGrowth(const LayerWork& work, const OutputChanges& changes) {
  if (changes.has_copied_map || !canBeInStrips(work)) return std::nullopt;
  const std::optional<SemanticState> former = storedSemanticState(work.transaction);
  if (!former || former->cluxels == 0) return std::nullopt;
  GrowthUpdate growth(work, changes, *former);
  return growth.isLarge() ? growth.run() : std::nullopt;
}

}  // namespace cluxel::mapping
