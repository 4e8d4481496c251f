// SPDX-License-Identifier: Apache-2.0
// Only cluxels of these objects are looked at: nothing is decided.
#include "mapping/window/passed_objects.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/stored_grid.hpp"
#include "mapping/window/kept_objects.hpp"
#include "mapping/window/map_window.hpp"
#include "mapping/window/window_presence.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// Tiles whose rectangle comes near a box.
bool comesNear(const perception::TileGrid& grid, const TileKey& tile, const Eigen::AlignedBox3d& box) {
  constexpr double kAround_m = 1;
  return boxOfTile(grid, tile)
             .exteriorDistance(Eigen::AlignedBox2d(Eigen::Vector2d(box.min().head<2>().array() - kAround_m),
                                                   Eigen::Vector2d(box.max().head<2>().array() + kAround_m))) <= 0;
}

/// Objects of which all tiles are read at once.
struct Together {
  std::map<ContentHash, rules::SemanticObject> objects;
  TileSet tiles;
};

/// Gives each object its cluxels in the held tiles, part by part.
void addCluxels(const rdf::ReadTransaction& transaction, const TileStages& stages, Together& together) {
  std::map<ContentHash, std::map<std::string, std::vector<std::uint32_t>>> parts;
  std::uint32_t first = 0;
  for (const auto& [tile, summary] : stages.summaries()) {
    const auto layer = storedLayer(transaction, tile);
    if (!layer || layer->size() != summary.size())
      refuseDamaged("stored tiles and what was decided about them do not belong together");
    for (std::uint32_t c = 0; c < layer->size(); ++c)
      if (const std::uint32_t share = layer->share_of_cluxel[c]; share != kNoShare)
        if (const ContentHash& id = layer->shares[share].object; together.objects.contains(id))
          parts[id][layer->shares[share].part_class].push_back(first + c);
    first += static_cast<std::uint32_t>(layer->size());
  }
  for (auto& [id, of_object] : parts)
    for (auto& [name, cluxels] : of_object) together.objects.at(id).parts.push_back({name, {}, std::move(cluxels)});
}

/// Reads the tiles of objects, some at a time.
class TargetSearch {
 public:
  TargetSearch(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed, TileStages& stages)
      : transaction_(transaction), parsed_(parsed), stages_(stages), all_(storedTiles(transaction)) {}

  std::vector<RayTarget> run(const std::set<ContentHash>& objects) {
    std::map<TileKey, std::vector<ContentHash>> by_place;
    for (const ContentHash& id : objects)
      if (const auto record = storedRecord(transaction_, id); record && !record->tiles.empty())
        by_place[record->tiles.front()].push_back(id);
    Together together;
    for (const auto& [tile, ids] : by_place) {
      for (const ContentHash& id : ids) add(id, together);
      if (together.tiles.size() >= kTilesAtOnce) collect(std::exchange(together, {}));
    }
    if (!together.objects.empty()) collect(std::move(together));
    return std::move(targets_);
  }

 private:
  static constexpr std::size_t kTilesAtOnce = 200;

  void add(const ContentHash& id, Together& together) const {
    const ObjectRecord record = storedRecord(transaction_, id).value();
    rules::SemanticObject& object = together.objects[id];
    object.id = id, object.class_iri = record.class_iri, object.rule_id = record.rule_id;
    object.confidence = record.confidence;
    together.tiles.insert(record.tiles.begin(), record.tiles.end());
  }

  void collect(Together together) {
    const TileSet around = without(perception::withRing(together.tiles, all_), together.tiles);
    stages_.hold(transaction_, together.tiles, around);
    perception::Scene scene;
    scene.cluxels = stages_.heldCluxels(around);
    addCluxels(transaction_, stages_, together);
    std::vector<rules::SemanticObject> asked;
    for (auto& [id, object] : together.objects)
      if (!object.parts.empty()) asked.push_back(std::move(object));
    std::vector<RayTarget> found = rayTargets(scene, asked, parsed_.rules);
    targets_.insert(targets_.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
  }

  const rdf::ReadTransaction& transaction_;
  const ParsedInputs& parsed_;
  TileStages& stages_;
  TileSet all_;
  std::vector<RayTarget> targets_;
};

}  // namespace

std::set<ContentHash> passedObjects(const rdf::ReadTransaction& transaction,
                                    const std::vector<Eigen::AlignedBox3d>& rays) {
  const perception::TileGrid grid = storedGrid(transaction);
  std::set<ContentHash> objects;
  for (const TileKey& tile : storedTiles(transaction)) {
    if (std::none_of(rays.begin(), rays.end(), [&](const auto& box) { return comesNear(grid, tile, box); })) continue;
    if (const auto layer = storedLayer(transaction, tile))
      for (const TileLayer::Share& share : layer->shares) objects.insert(share.object);
  }
  std::erase_if(objects, [&](const ContentHash& id) {
    const auto record = storedRecord(transaction, id);
    return !record || record->is_class_wide;
  });
  return objects;
}

std::vector<RayTarget> targetsOf(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed,
                                 TileStages& stages, const std::set<ContentHash>& objects) {
  return TargetSearch(transaction, parsed, stages).run(objects);
}

void updatePassedObjects(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                         const std::vector<Cloud>& clouds, const std::set<ContentHash>& objects,
                         const MapWindow& window, unsigned threads) {
  std::set<ContentHash> beyond;
  for (const ContentHash& id : objects)
    if (const auto record = storedRecord(transaction, id); record && !isInside(*record, window)) beyond.insert(id);
  if (!beyond.empty()) tellPresence(transaction, targetsOf(transaction, parsed, stages, beyond), clouds, {}, threads);
}

}  // namespace cluxel::mapping
