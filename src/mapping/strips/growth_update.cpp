// SPDX-License-Identifier: Apache-2.0
// What changed in tiles that were there is decided with the strip in which they lie; until then they count as they
// were.
#include "mapping/strips/growth_update.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "base/free_memory.hpp"
#include "mapping/build/way_telling.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/strips/map_strips.hpp"
#include "mapping/strips/whole_update.hpp"
#include "mapping/window/passed_objects.hpp"
#include "mapping/window/window_presence.hpp"
#include "rules/objects/known_splits.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

class GrowthUpdate {
 public:
  GrowthUpdate(const LayerWork& work, OutputChanges& changes, const SemanticState& former)
      : work_(work),
        transaction_(work.transaction),
        before_(work.transaction.before()),
        changes_(changes),
        former_(former),
        all_(storedTiles(work.transaction)) {
    params_.max_window_share = kNoWindowLimit;
    for (const auto& [tile, summary] : changes.former_summaries)
      if (!summary && all_.contains(tile)) new_.insert(tile);
    other_ = without(TileSet(changes.tiles), new_);
    const auto& at_hand = work.stages.summaries();
    cluxels_ = cluxelsIn(transaction_, new_, at_hand) + cluxelsIn(transaction_, other_, at_hand);
    strip_.told_clouds = former.clouds;
    strip_.keeps_lists = params_.lists_objects;
    strip_.splits = &splits_, strip_.later = &made_;
  }
  GrowthUpdate(const GrowthUpdate&) = delete;
  GrowthUpdate& operator=(const GrowthUpdate&) = delete;
  ~GrowthUpdate() { work_.stages.readAsBefore(nullptr, {}); }

  bool isLarge() const { return cluxels_ > params_.whole_cluxels; }

  /// Whether the change lies all over the map. Each strip then has unchanged tiles on all sides, so that deciding the
  /// whole map is faster. Where nearly all tiles changed, strips are as fast, and need no list of all objects.
  bool isScattered() const {
    constexpr double kNearlyAll = 0.9;
    const auto shareOf = [this](std::size_t tiles) {
      return static_cast<double>(tiles) / static_cast<double>(all_.size());
    };
    const std::size_t around = perception::withRing(other_, all_).size();
    return shareOf(new_.size() + other_.size()) < kNearlyAll && shareOf(around) > work_.params.max_window_share;
  }

  std::optional<SemanticUpdate> run() {
    const std::vector<ContentHash> wide = wideObjects();
    dropCommittedSummaries();
    SemanticUpdate update;
    bool is_first = true;
    const TileSet changed = perception::unionOf(TileSet(new_), other_);
    for (const TileSet& tiles : layerStripsOf(transaction_, changed, cluxels_, params_.whole_cluxels)) {
      if (work_.check) work_.check(0);
      auto decided = decide(tiles);
      if (!decided && is_first) {
        readCommittedSummaries();
        return std::nullopt;
      }
      if (!decided) return decideWholeMap();
      is_first = false;
      update.tiles_decided += decided->tiles_decided;
      update.objects = decided->objects, update.cluxels = decided->cluxels, update.primitives = decided->primitives;
      difference_.add(std::move(static_cast<DifferentObjects&>(*decided)));
      strip_.told_clouds = seenClouds(storedClouds(transaction_));
      transaction_.writePages();
      returnFreeMemory();
    }
    if (!std::all_of(wide.begin(), wide.end(), [&](const ContentHash& id) { return isThere(id); }))
      return decideWholeMap();
    tellRays();
    tellWaysWithoutGone(transaction_, work_.parsed, work_.stages, params_.threads);
    transaction_.writePages();
    returnFreeMemory();
    update.whole_rules = inferFacts(transaction_, work_.parsed.inputs, work_.sink, work_.check);
    const rdf::ReadTransaction& reading = transaction_;
    update.statements = toldOutcomes(rdf::QuadReader(reading));
    update.is_local = true;
    return withLists(std::move(update));
  }

 private:
  /// Shows `tiles` as they are now. Tiles beside them that are still as before would not fit: they are hidden until it
  /// is their turn.
  std::optional<SemanticUpdate> decide(const TileSet& tiles) {
    const TileSet other = without(TileSet(other_), tiles), fresh = without(TileSet(new_), tiles);
    TileSet settled = perception::unionOf(TileSet(settled_), tiles);
    TileSet hidden = perception::withRing(settled, other);
    strip_.shown = without(without(TileSet(all_), fresh), hidden);
    OutputChanges changes;
    for (const TileKey& tile : tiles) noteChange(tile, new_.contains(tile) || hidden_.contains(tile), changes);
    for (const TileKey& tile : without(TileSet(hidden), hidden_)) noteHidden(tile, changes);
    strip_.anew = perception::withRing(perception::unionOf(TileSet(tiles), hidden), strip_.shown);
    changes.tiles.insert(strip_.anew.begin(), strip_.anew.end());
    work_.stages.readAsBefore(&before_, other);
    strip_.as_before = other;
    const LayerWork work{work_.transaction, work_.parsed, work_.stages, params_, work_.sink, work_.check};
    auto decided = updateAround(work, changes, ChangedInputs::Scans, nullptr, &strip_);
    if (!decided) return std::nullopt;
    other_ = other, new_ = fresh, settled_ = std::move(settled), hidden_ = std::move(hidden);
    return decided;
  }

  void noteChange(const TileKey& tile, bool was_absent, OutputChanges& changes) const {
    changes.tiles.insert(tile);
    if (was_absent)
      changes.former_summaries.emplace(tile, std::nullopt);
    else if (committed_.contains(tile))
      changes.former_summaries.emplace(tile, committedSummary(tile));
    else if (const auto former = changes_.former_summaries.find(tile); former != changes_.former_summaries.end())
      changes.former_summaries.insert(*former);
  }

  void noteHidden(const TileKey& tile, OutputChanges& changes) const {
    changes.tiles.insert(tile);
    changes.former_summaries.emplace(tile, committedSummary(tile));
  }

  /// Former summaries are large. Those that the commit before holds are read from there when their strip comes.
  void dropCommittedSummaries() {
    for (auto& [tile, summary] : changes_.former_summaries)
      if (summary && before_.block(tables::kSummaries, tables::keyOf(tile)) == *summary) {
        committed_.insert(tile);
        std::string().swap(*summary);
      }
  }
  void readCommittedSummaries() {
    for (const TileKey& tile : committed_) changes_.former_summaries[tile] = committedSummary(tile);
  }
  std::string committedSummary(const TileKey& tile) const {
    return std::string(requiredBlock(before_, tables::kSummaries, tile));
  }

  /// Tells what rays say about objects that strips have made, and about others that rays of the new scans pass.
  void tellRays() {
    if (work_.check) work_.check(0);
    work_.stages.readAsBefore(nullptr, {});
    const std::vector<Cloud> clouds = storedClouds(transaction_);
    std::set<ContentHash> passed = passedObjects(transaction_, changedRays(former_.clouds, seenClouds(clouds)));
    std::erase_if(passed, [&](const ContentHash& object) { return made_.contains(object); });
    made_.add(targetsOf(transaction_, work_.parsed, work_.stages, passed));
    tellPresence(transaction_, made_.take(), clouds, made_.removed(), params_.threads);
  }

  /// Decides the whole map, when a strip cannot be decided alone.
  SemanticUpdate decideWholeMap() {
    work_.stages.readAsBefore(nullptr, {});
    OutputChanges rest;
    for (const TileKey& tile : new_) noteChange(tile, true, rest);
    for (const TileKey& tile : other_) noteChange(tile, hidden_.contains(tile), rest);
    SemanticUpdate update = updateAll(work_, std::move(rest));
    difference_.add(std::move(static_cast<DifferentObjects&>(update)));
    return withLists(std::move(update));
  }

  SemanticUpdate withLists(SemanticUpdate update) {
    static_cast<DifferentObjects&>(update) = std::move(difference_).take();
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
  rdf::ReadTransaction before_;
  OutputChanges& changes_;
  const SemanticState& former_;
  TileSet all_;                ///< of the map
  TileSet new_;                ///< that are not shown yet
  TileSet other_;              ///< that were there and have other outputs now: so far they count as they were
  TileSet committed_;          ///< whose former summaries are those of the commit before, and not in changes_
  TileSet settled_;            ///< that are shown as they are now
  TileSet hidden_;             ///< of the other ones: those beside settled ones
  std::uint64_t cluxels_ = 0;  ///< of new and other tiles
  UpdateParams params_ = work_.params;
  rules::KnownSplits splits_;  ///< windows of strips overlap
  LaterTargets made_;
  MapStrip strip_;
  ObjectDifference difference_;
};

/// Whether scans were only added: no tile is gone, and points of tiles as they were are those of scans as they are.
bool isOnlyAdded(const rdf::ReadTransaction& transaction, const OutputChanges& changes, const SemanticState& former) {
  const TileSet tiles = storedTiles(transaction);
  std::map<ContentHash, ContentHash> now;
  for (const SeenCloud& cloud : seenClouds(storedClouds(transaction))) now.emplace(cloud.id, cloud.content);
  return std::includes(tiles.begin(), tiles.end(), changes.tiles.begin(), changes.tiles.end()) &&
         std::all_of(former.clouds.begin(), former.clouds.end(), [&](const SeenCloud& cloud) {
           const auto same = now.find(cloud.id);
           return same != now.end() && same->second == cloud.content;
         });
}

}  // namespace

std::optional<SemanticUpdate> updateByGrowth(const LayerWork& work, OutputChanges& changes) {
  if (changes.has_copied_map || !work.params.is_first_of_commit || !canBeInStrips(work)) return std::nullopt;
  const std::optional<SemanticState> former = storedSemanticState(work.transaction);
  if (!former || former->cluxels == 0) return std::nullopt;
  if (!isOnlyAdded(work.transaction, changes, *former)) return std::nullopt;
  GrowthUpdate growth(work, changes, *former);
  return growth.isLarge() && !growth.isScattered() ? growth.run() : std::nullopt;
}

}  // namespace cluxel::mapping
