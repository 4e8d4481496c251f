// SPDX-License-Identifier: Apache-2.0
// Copies what the lender decided outside the border, and marks the border as changed.
#include "mapping/window/lent_decisions.hpp"

#include <algorithm>

#include "mapping/build/freed_tiles.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/statements/overruled_objects.hpp"
#include "mapping/statements/statement_places.hpp"
#include "mapping/window/passed_objects.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;

/// Rings around the tiles of both maps that are likely to be decided anew. The number was chosen, not measured.
constexpr int kRingsDecided = 2;

bool hasWideObjectsButGround(const rdf::ReadTransaction& map) {
  bool has = false;
  forEachRecord(map, [&](const ContentHash&, const ObjectRecord& record) {
    has = has || (record.is_class_wide && record.class_iri != rdf::vocabulary::clx("Ground"));
  });
  return has;
}

/// All clouds, ascending by id. Absent when a cloud of both is not the same in both.
std::optional<std::vector<SeenCloud>> unionOfClouds(const std::vector<SeenCloud>& a, const std::vector<SeenCloud>& b) {
  std::map<ContentHash, SeenCloud> clouds;
  for (const SeenCloud& cloud : a) clouds.emplace(cloud.id, cloud);
  for (const SeenCloud& cloud : b) {
    const auto [known, is_new] = clouds.emplace(cloud.id, cloud);
    if (!is_new && (known->second.content != cloud.content || known->second.time_s != cloud.time_s))
      return std::nullopt;
  }
  std::vector<SeenCloud> all;
  for (auto& [id, cloud] : clouds) all.push_back(std::move(cloud));
  return all;
}

/// The bounds of the rays of clouds that only `a` has.
std::vector<Eigen::AlignedBox3d> raysOfOthers(const std::vector<SeenCloud>& a, const std::vector<SeenCloud>& b) {
  std::set<ContentHash> of_b;
  for (const SeenCloud& cloud : b) of_b.insert(cloud.id);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SeenCloud& cloud : a)
    if (!of_b.contains(cloud.id)) boxes.push_back(cloud.rays);
  return boxes;
}

/// The tiles of both maps, and those of the lender beside tiles of the map.
TileSet borderOf(const TileSet& own, const TileSet& of_lender) {
  return perception::withRing(own, of_lender);
}

/// The share of all tiles that is likely to be decided anew: those of both maps, or where there are none those beside
/// the other map, with some rings around.
double likelyShareDecided(const TileSet& own, const TileSet& of_lender) {
  TileSet decided;
  std::set_intersection(own.begin(), own.end(), of_lender.begin(), of_lender.end(),
                        std::inserter(decided, decided.end()));
  if (decided.empty()) decided = perception::withRing(perception::grown(own), of_lender);
  const TileSet all = perception::unionOf(own, of_lender);
  for (int ring = 0; ring < kRingsDecided; ++ring) decided = perception::withRing(decided, all);
  if (all.empty()) return 0;
  return static_cast<double>(decided.size()) / static_cast<double>(all.size());
}

TileLayer requiredLayer(const rdf::ReadTransaction& map, const TileKey& tile) {
  if (std::optional<TileLayer> layer = storedLayer(map, tile)) return *std::move(layer);
  refuseIncompleteTile();
}

void copyBlock(rdf::WriteTransaction& into, const rdf::ReadTransaction& from, std::string_view table,
               const TileKey& tile) {
  const std::string key = tables::keyOf(tile);
  if (const auto block = from.block(table, key)) into.putBlock(table, key, *block);
}

}  // namespace

bool canLendDecisions(const rdf::ReadTransaction& map, const rdf::ReadTransaction& lender, double max_share,
                      std::size_t max_border_tiles) {
  const std::optional<SemanticState> own = storedSemanticState(map), other = storedSemanticState(lender);
  const TileSet tiles = storedTiles(map), of_lender = storedTiles(lender);
  if (!own || !other || borderOf(tiles, of_lender).size() > max_border_tiles ||
      likelyShareDecided(tiles, of_lender) > max_share)
    return false;
  const auto clouds = unionOfClouds(own->clouds, other->clouds);
  if (!clouds || tellsPresence(own->clouds) != tellsPresence(*clouds) ||
      tellsPresence(other->clouds) != tellsPresence(*clouds))
    return false;
  return !hasWideObjectsButGround(map) && !hasWideObjectsButGround(lender);
}

LentDecisions::LentDecisions(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& lender)
    : transaction_(transaction), lender_(lender) {
  for (const TileKey& tile : storedTiles(transaction))
    if (transaction.block(tables::kTileLayers, tables::keyOf(tile))) own_.insert(tile);
  const TileSet of_lender = storedTiles(lender);
  for (const TileKey& tile : of_lender) (own_.contains(tile) ? common_ : lent_).insert(tile);
  border_ = borderOf(own_, of_lender);
  own_state_ = storedSemanticState(transaction).value();
  state_of_lender_ = storedSemanticState(lender).value();
  const std::vector<SeenCloud>&of_own = own_state_.clouds, &of_other = state_of_lender_.clouds;
  passed_ = passedObjects(transaction, raysOfOthers(of_other, of_own));
  passed_.merge(passedObjects(lender, raysOfOthers(of_own, of_other)));
  state_.cluxels = own_state_.cluxels + state_of_lender_.cluxels;
  state_.primitives = own_state_.primitives + state_of_lender_.primitives;
  state_.objects = own_state_.objects;
  state_.clouds = unionOfClouds(of_own, of_other).value();
  std::set<ContentHash> statements(own_state_.statements.begin(), own_state_.statements.end());
  statements.insert(state_of_lender_.statements.begin(), state_of_lender_.statements.end());
  state_.statements.assign(statements.begin(), statements.end());
}

void LentDecisions::lend(OutputChanges& changes, TileStages& stages) {
  readCommonTiles();
  lendRows();
  lendRecords();
  lendStatements();
  noteChanges(changes, stages);
  facts_.emplace(lender_, not_lent_);
}

/// What the lender decided about tiles of both maps is not taken.
void LentDecisions::readCommonTiles() {
  for (const TileKey& tile : common_) {
    const TileLayer layer = requiredLayer(lender_, tile);
    state_.cluxels -= layer.size();
    for (const TileLayer::PrimitiveHere& primitive : layer.primitives) not_lent_.primitives.insert(primitive.id);
    for (const TileLayer::Share& share : layer.shares) not_lent_.objects.insert(share.object);
  }
  std::set<ContentHash> ends_here = not_lent_.primitives;
  for (const TileKey& tile : perception::withRing(common_, lent_)) {
    const TileLayer layer = requiredLayer(lender_, tile);
    for (const TileLayer::PrimitiveHere& primitive : layer.primitives) ends_here.erase(primitive.id);
  }
  state_.primitives -= ends_here.size();
}

void LentDecisions::lendRows() {
  for (const TileKey& tile : lent_)
    for (const std::string_view table : {tables::kTileLayers, tables::kMargins, tables::kWideTiles})
      copyBlock(transaction_, lender_, table, tile);
  if (!copyFreedTiles(transaction_, lender_, lent_)) return;  // ways that the map lacks are made
  for (const TileKey& tile : lent_)
    for (const std::string_view table : {tables::kSurfaces, tables::kWays})
      copyBlock(transaction_, lender_, table, tile);
}

void LentDecisions::lendRecords() {
  forEachRecord(lender_, [this](const ContentHash& id, const ObjectRecord& record) { lendRecord(id, record); });
  for (const ContentHash& wide : not_lent_.wide) not_lent_.objects.erase(wide);
  state_.objects += added_.size();
}

void LentDecisions::lendRecord(const ContentHash& id, const ObjectRecord& record) {
  const auto is_lent = [this](const TileKey& tile) { return lent_.contains(tile); };
  if (record.is_class_wide) not_lent_.wide.insert(id);
  if (std::none_of(record.tiles.begin(), record.tiles.end(), is_lent)) return;
  ObjectRecord now = record;
  if (record.is_class_wide) {
    std::erase_if(now.tiles, [&](const TileKey& tile) { return !is_lent(tile); });
    tiles_of_wide_.insert(now.tiles.front());
    if (const auto own = storedRecord(transaction_, id)) {
      widened_.emplace(id, toBytes(*own));
      now.tiles.insert(now.tiles.end(), own->tiles.begin(), own->tiles.end());
      std::sort(now.tiles.begin(), now.tiles.end());
    }
  } else if (!std::all_of(record.tiles.begin(), record.tiles.end(), is_lent)) {
    reaching_.insert(id);
  }
  if (!widened_.contains(id)) added_.insert(id);
  transaction_.putBlock(tables::kObjects, tables::keyOf(id), toBytes(now));
}

/// Takes only rows of objects with lent tiles. Objects in common tiles alone are decided anew.
void LentDecisions::lendStatements() {
  for (const OverruledRecord& record : overruledRecords(lender_)) {
    const TileSet tiles = tilesOf(record);
    if (std::any_of(tiles.begin(), tiles.end(), [this](const TileKey& tile) { return lent_.contains(tile); }))
      putOverruled(transaction_, record);
  }
  StatementTiles tiles = storedStatementTiles(transaction_);
  for (const auto& [statement, places] : storedStatementTiles(lender_))
    tiles[statement].insert(places.begin(), places.end());
  storeStatementTiles(transaction_, tiles);
}

void LentDecisions::noteChanges(OutputChanges& changes, TileStages& stages) const {
  TileSet same_even, same;
  for (const TileKey& tile : lent_) {
    if (haveSameOutput(transaction_, lender_, perception::Stage::Even, tile)) same_even.insert(tile);
    const std::string_view former = requiredBlock(lender_, tables::kSummaries, tile);
    if (former == transaction_.block(tables::kSummaries, tables::keyOf(tile)))
      changes.former_summaries.erase(tile);
    else
      changes.former_summaries.insert_or_assign(tile, std::string(former));
    if (!haveSameOutputs(transaction_, lender_, tile)) continue;
    changes.tiles.erase(tile);
    same.insert(tile);
  }
  changes.tiles.insert(border_.begin(), border_.end());
  stages.noteEven(same_even, border_);
  stages.noteOutputs(same, border_);  // freed tiles that were lent follow from the same but along the border
}

void LentDecisions::takeBack() {
  for (const TileKey& tile : lent_)
    for (const std::string_view table : {tables::kTileLayers, tables::kMargins, tables::kWideTiles})
      transaction_.eraseBlock(table, tables::keyOf(tile));
  for (const ContentHash& id : added_) transaction_.eraseBlock(tables::kObjects, tables::keyOf(id));
  for (const auto& [id, record] : widened_) transaction_.putBlock(tables::kObjects, tables::keyOf(id), record);
}

bool LentDecisions::isCoveredBy(const WindowDecision& decision, const std::vector<rules::SemanticObject>& wide) const {
  const auto is_told = [&](const ContentHash& id) {
    return std::any_of(wide.begin(), wide.end(), [&](const rules::SemanticObject& object) { return object.id == id; });
  };
  return std::all_of(reaching_.begin(), reaching_.end(),
                     [&](const ContentHash& id) { return decision.replaced.contains(id); }) &&
         std::all_of(not_lent_.wide.begin(), not_lent_.wide.end(), is_told);
}

}  // namespace cluxel::mapping
