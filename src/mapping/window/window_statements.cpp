// SPDX-License-Identifier: Apache-2.0
// Tiles are added until no statement and no changed object lies partly in what is decided anew.
#include "mapping/window/window_statements.hpp"

#include <algorithm>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

using perception::PrimitiveIndex;
using perception::TileKey;
using perception::TileSet;

bool haveCommon(const TileSet& a, const TileSet& b) {
  const TileSet &few = a.size() < b.size() ? a : b, &many = a.size() < b.size() ? b : a;
  return std::any_of(few.begin(), few.end(), [&](const TileKey& tile) { return many.contains(tile); });
}

bool includes(const TileSet& all, const TileSet& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

std::set<ContentHash> changedClouds(const std::vector<SeenCloud>& before, const std::vector<SeenCloud>& now) {
  std::map<ContentHash, ContentHash> contents;
  for (const SeenCloud& cloud : before) contents.emplace(cloud.id, cloud.content);
  std::set<ContentHash> changed;
  for (const SeenCloud& cloud : now) {
    const auto known = contents.find(cloud.id);
    if (known == contents.end() || known->second != cloud.content) changed.insert(cloud.id);
    if (known != contents.end()) contents.erase(known);
  }
  for (const auto& [gone, content] : contents) changed.insert(gone);
  return changed;
}

bool isAnchoredTo(const Statement& statement, const std::set<ContentHash>& clouds) {
  if (statement.kind == StatementKind::IgnoreRegion) return clouds.contains(statement.region.scan);
  return std::any_of(statement.points.begin(), statement.points.end(),
                     [&](const auto& points) { return clouds.contains(points.first); });
}

/// The statements that the maps before had, each with the clouds that have changed for it.
class Former {
 public:
  Former(const std::vector<SemanticState>& maps, const SemanticState& now) {
    for (const SemanticState& map : maps) {
      known.insert(map.statements.begin(), map.statements.end());
      maps_.push_back({{map.statements.begin(), map.statements.end()}, changedClouds(map.clouds, now.clouds)});
    }
  }
  /// Whether a map lacked the statement's clouds as they are now, or no map had the statement.
  bool isOther(const Statement& statement) const {
    const ContentHash id = statement.id();
    return !known.contains(id) || std::any_of(maps_.begin(), maps_.end(), [&](const StatedIn& map) {
      return map.statements.contains(id) && isAnchoredTo(statement, map.changed_clouds);
    });
  }

  std::set<ContentHash> known;  ///< by some map

 private:
  struct StatedIn {
    std::set<ContentHash> statements, changed_clouds;
  };
  std::vector<StatedIn> maps_;
};

}  // namespace

/// The cluxels of a window that are decided anew, or belong to an object that is.
struct WindowStatements::Touched {
  std::vector<char> is_touched;  ///< by cluxel
  TileSet tiles;                 ///< with such cluxels

  Touched(const MapWindow& window, const WindowDecision& decision) {
    const perception::SceneCluxels& all = window.scene.cluxels;
    for (const PrimitiveIndex primitive : all.primitive) is_touched.push_back(decision.is_decided[primitive]);
    for (const rules::SemanticObject& object : decision.objects)
      for (const rules::ObjectPart& part : object.parts)
        for (const std::uint32_t cluxel : part.cluxels) is_touched[cluxel] = 1;
    for (std::uint32_t c = 0; c < all.size(); ++c)
      if (is_touched[c] != 0) tiles.insert(tiles.end(), all.name[c].tile);
  }
};

WindowStatements::WindowStatements(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed,
                                   TileStages& stages, const std::vector<Cloud>& clouds, const OutputChanges& changes,
                                   const std::vector<SemanticState>& before, const SemanticState& now)
    : transaction_(transaction), parsed_(parsed), stages_(stages), clouds_(clouds) {
  const Former statements_before(before, now);
  if (statements_before.known.empty() && now.statements.empty()) return;
  statements_ = storedStatements(rdf::QuadReader(transaction));
  records_ = overruledRecords(transaction);
  const StatementTiles former = storedStatementTiles(transaction);
  const TileSet map = perception::unionOf(storedTiles(transaction), changes.tiles);
  PointOwners owners(transaction, stages, parsed.model.perception.thin, clouds);
  TileSet concerned;
  for (const Statement& statement : statements_) {
    const ContentHash id = statement.id();
    if (!statement.class_iri.empty()) {
      places_[id] = {};
      continue;
    }
    const auto known = former.find(id);
    // An earlier program let a statement that is anchored to points apply to the ground.
    bool is_changed = known == former.end() || statements_before.isOther(statement) || saysOfWideObject(id);
    const bool is_region = statement.kind == StatementKind::IgnoreRegion;
    places_[id] = is_changed || is_region ? tilesOf(statement, owners, clouds, map) : known->second;
    is_changed = is_changed || (before.size() > 1 && places_[id] != known->second);  // a region in another map
    if (is_changed) concerned_.insert(id);
    if (!is_changed && !haveCommon(places_[id], changes.tiles)) continue;
    concerned.insert(places_[id].begin(), places_[id].end());
    if (known != former.end()) concerned.insert(known->second.begin(), known->second.end());
  }
  for (const ContentHash& id : statements_before.known) {
    if (places_.contains(id)) continue;
    withdrawn_.push_back(id);
    needs_whole_map_ = needs_whole_map_ || saysOfWideObject(id);
    if (const auto known = former.find(id); known != former.end())
      concerned.insert(known->second.begin(), known->second.end());
  }
  for (const OverruledRecord& record : records_)
    if (const TileSet tiles = tilesOf(record); haveCommon(tiles, changes.tiles))
      concerned.insert(tiles.begin(), tiles.end());
  grow(concerned);
}

/// Adds these tiles, and those of all statements and changed objects in them. When they are there already, more tiles
/// do not help.
void WindowStatements::grow(const TileSet& tiles) {
  if (!tiles.empty() && includes(tiles_, tiles)) needs_whole_map_ = true;
  tiles_.insert(tiles.begin(), tiles.end());
  for (std::size_t count = 0; count != tiles_.size();) {
    count = tiles_.size();
    for (const auto& [id, places] : places_)
      if (haveCommon(places, tiles_)) {
        concerned_.insert(id);
        tiles_.insert(places.begin(), places.end());
      }
    for (const OverruledRecord& record : records_)
      if (const TileSet own = tilesOf(record); haveCommon(own, tiles_)) tiles_.insert(own.begin(), own.end());
  }
}

/// Grows by the tiles of statements and changed objects that lie in what is decided, and in tiles that need not be.
/// True when there are such: the decision cannot be used.
bool WindowStatements::growByPartlyDecided(const MapWindow& window, const WindowChange& change,
                                           const WindowDecision& decision, const Touched& touched) {
  PointOwners owners(transaction_, stages_, parsed_.model.perception.thin, clouds_);
  TileSet more;
  for (const Statement& statement : statements_) {
    const ContentHash id = statement.id();
    if (concerned_.contains(id) || !haveCommon(places_[id], touched.tiles)) continue;
    const std::vector<std::uint32_t> cluxels = owners.cluxelsOf(statement.points);
    if (statement.kind == StatementKind::IgnoreRegion ||
        std::any_of(cluxels.begin(), cluxels.end(), [&](auto cluxel) { return touched.is_touched[cluxel] != 0; }))
      more.insert(places_[id].begin(), places_[id].end());
  }
  std::set<ContentHash> decided = change.gone;
  for (PrimitiveIndex i = 0; i < decision.is_decided.size(); ++i)
    if (decision.is_decided[i] != 0) decided.insert(window.scene.primitives[i].id);
  erased_.clear();
  for (const OverruledRecord& record : records_) {
    const bool is_decided = std::any_of(record.parts.begin(), record.parts.end(), [&](const auto& part) {
      return std::any_of(part.primitives.begin(), part.primitives.end(),
                         [&](const ContentHash& primitive) { return decided.contains(primitive); });
    });
    if (!is_decided) continue;
    erased_.insert(record.by_rules);
    if (const TileSet own = tilesOf(record); !includes(tiles_, own)) more.insert(own.begin(), own.end());
  }
  grow(more);
  return !more.empty();
}

bool WindowStatements::apply(const MapWindow& window, const WindowChange& change, WindowDecision& decision) {
  if (statements_.empty() && records_.empty()) return true;
  const Touched touched(window, decision);
  if (growByPartlyDecided(window, change, decision, touched)) return false;
  std::vector<Statement> about;
  std::copy_if(statements_.begin(), statements_.end(), std::back_inserter(about),
               [&](const Statement& statement) { return concerned_.contains(statement.id()); });
  if (needs_whole_map_) return false;
  PointOwners owners(transaction_, stages_, parsed_.model.perception.thin, clouds_);
  applied_ = applyStatements(about, decision.objects, window.scene, parsed_.rules.catalogue, owners, clouds_);
  if (growByPartlyChanged(window, decision)) return false;
  decision.objects = std::move(applied_.objects);
  addAboutWideObjects();
  return true;
}

/// What is stated of class-wide objects is told with each window, because their facts are made anew there. Whether
/// there is such an object does not change with a window.
void WindowStatements::addAboutWideObjects() {
  for (const Statement& statement : statements_) {
    if (statement.class_iri.empty()) continue;
    StatementOutcome outcome{statement, StatementEffect::Dormant, std::nullopt, "", false};
    const ContentHash object = rules::idOfClassWide(statement.class_iri);
    if (storedRecord(transaction_, object)) {
      outcome.effect = StatementEffect::Applied;
      outcome.object = object;
      outcome.rules_class = statement.class_iri;
    }
    applied_.outcomes.push_back(std::move(outcome));
  }
}

/// Whether a withdrawn statement was about a class-wide object, of which what it said has to be removed.
bool WindowStatements::saysOfWideObject(const ContentHash& id) const {
  const rdf::QuadReader quads(transaction_);
  for (const Quad& quad : quadsAbout(quads, rdf::iriOfStatement(id), rdf::vocabulary::kGraphObserved)) {
    if (quad.predicate.text != rdf::vocabulary::clx("appliesTo")) continue;
    const auto object = hashIn(quad.object.text, "object");
    const auto record = object ? storedRecord(transaction_, *object) : std::nullopt;
    if (record && record->is_class_wide) return true;
  }
  return false;
}

/// Grows by the tiles of objects that statements change and of which not all is decided anew. True when there are such,
/// or when the whole map has to be computed: the decision cannot be used.
bool WindowStatements::growByPartlyChanged(const MapWindow& window, const WindowDecision& decision) {
  const perception::SceneCluxels& all = window.scene.cluxels;
  TileSet more;
  for (const OverruledObject& overruled : applied_.overruled) {
    const std::vector<std::uint32_t> members = cluxelsOf(overruled.by_rules);
    if (std::all_of(members.begin(), members.end(),
                    [&](auto cluxel) { return decision.is_decided[all.primitive[cluxel]] != 0; }))
      continue;
    for (const std::uint32_t cluxel : members) more.insert(all.name[cluxel].tile);
  }
  grow(more);
  return needs_whole_map_ || !more.empty();
}

std::vector<ContentHash> WindowStatements::exchanged() const {
  std::vector<ContentHash> ids = withdrawn_;
  for (const StatementOutcome& outcome : applied_.outcomes) ids.push_back(outcome.statement.id());
  return ids;
}

void WindowStatements::store(rdf::WriteTransaction& transaction, const MapWindow& window) {
  for (const ContentHash& record : erased_) eraseOverruled(transaction, record);
  for (const OverruledObject& overruled : applied_.overruled)
    putOverruled(transaction, recordOf(overruled, window.scene));
  StatementTiles kept = places_;
  const TileSet map = storedTiles(transaction);
  for (const Statement& statement : statements_)
    if (statement.kind == StatementKind::IgnoreRegion)  // of points all tiles are kept: a tile may come back
      std::erase_if(kept[statement.id()], [&](const TileKey& tile) { return !map.contains(tile); });
  storeStatementTiles(transaction, kept);
}

}  // namespace cluxel::mapping
