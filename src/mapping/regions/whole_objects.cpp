// SPDX-License-Identifier: Apache-2.0
// Objects are read with the region of their first tile.
#include "mapping/regions/whole_objects.hpp"

#include <algorithm>

#include "mapping/build/tile_stages.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/tile_regions.hpp"
#include "perception/segments/summary_tile.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

class WholeObjects {
 public:
  WholeObjects(const MapReader& map, const std::vector<bool>& is_wanted)
      : map_(map),
        inputs_(map.inputs()),
        stages_(map.model(), inputs_.params),
        all_tiles_(storedTiles(map.transaction())) {
    std::uint32_t number = 0;
    forEachRecord(map.transaction(), [&](const ContentHash&, const ObjectRecord& record) {
      if (is_wanted.at(number) && record.tiles.empty()) refuseDamaged("an object has no cluxels");
      if (is_wanted[number]) wanted_in_[record.tiles.front()].push_back(number);
      ++number;
    });
  }

  void visitAll(const std::function<void(const WholeObject&)>& visit, std::size_t max_cluxels) {
    std::vector<CountedTile> tiles;
    for (const auto& [tile, objects] : wanted_in_)
      tiles.push_back({tile, perception::cluxelsIn(requiredBlock(map_.transaction(), tables::kSummaries, tile))});
    for (const TileSet& region : regionsOf(std::move(tiles), max_cluxels)) visitRegion(region, visit);
  }

 private:
  void visitRegion(const TileSet& region, const std::function<void(const WholeObject&)>& visit) {
    std::map<ContentHash, std::pair<std::uint32_t, rules::SemanticObject>> objects;
    TileSet held;
    for (const TileKey& tile : region)
      for (const std::uint32_t number : wanted_in_.at(tile)) {
        const ContentHash& id = map_.objectIds().at(number);
        const std::optional<ObjectRecord> record = storedRecord(map_.transaction(), id);
        if (!record) refuseDamaged("an object is not there");
        held.insert(record->tiles.begin(), record->tiles.end());
        auto& [place, object] = objects[id];
        place = number;
        object.id = id, object.class_iri = record->class_iri, object.rule_id = record->rule_id;
        object.confidence = record->confidence, object.is_class_wide = record->is_class_wide;
      }
    const TileSet around = without(perception::withRing(held, all_tiles_), held);
    stages_.hold(map_.transaction(), held, around);
    const perception::SceneCluxels cluxels = stages_.heldCluxels(around);
    std::uint32_t first = 0;
    for (const TileKey& tile : held) first = addTile(tile, first, objects);
    for (auto& [id, entry] : objects) {
      if (entry.second.parts.empty()) refuseDamaged("an object has no cluxels");
      visit({entry.first, std::move(entry.second), cluxels});
    }
  }

  /// Returns the number of the first cluxel of the next tile.
  template <typename Objects>
  std::uint32_t addTile(const TileKey& tile, std::uint32_t first, Objects& objects) const {
    const auto layer = storedLayer(map_.transaction(), tile);
    const auto summary = stages_.summaries().find(tile);
    if (!layer || summary == stages_.summaries().end()) refuseIncompleteTile();
    if (layer->size() != summary->second.size()) refuseDamaged("a stored tile does not fit its objects");
    std::vector<std::vector<std::uint32_t>> cluxels(layer->shares.size());
    for (std::uint32_t c = 0; c < layer->size(); ++c)
      if (layer->share_of_cluxel[c] != kNoShare) cluxels.at(layer->share_of_cluxel[c]).push_back(first + c);
    for (std::size_t share = 0; share < cluxels.size(); ++share) {
      const auto object = objects.find(layer->shares[share].object);
      if (object == objects.end()) continue;
      std::vector<std::uint32_t>& all = partNamed(object->second.second.parts, layer->shares[share].part_class).cluxels;
      all.insert(all.end(), cluxels[share].begin(), cluxels[share].end());
    }
    return first + static_cast<std::uint32_t>(layer->size());
  }

  /// Parts are sorted by class, as those of MapReader::objects().
  static rules::ObjectPart& partNamed(std::vector<rules::ObjectPart>& parts, const std::string& name) {
    const auto place = std::lower_bound(parts.begin(), parts.end(), name,
                                        [](const auto& part, const std::string& n) { return part.part_class < n; });
    if (place != parts.end() && place->part_class == name) return *place;
    return *parts.insert(place, {name, {}, {}});
  }

  const MapReader& map_;
  MapInputs inputs_;
  TileStages stages_;
  TileSet all_tiles_;
  std::map<TileKey, std::vector<std::uint32_t>> wanted_in_;  ///< by their first tile
};

}  // namespace

void forEachWholeObject(const MapReader& map, const std::vector<bool>& is_wanted,
                        const std::function<void(const WholeObject&)>& visit, std::size_t max_cluxels) {
  WholeObjects(map, is_wanted).visitAll(visit, max_cluxels);
}

}  // namespace cluxel::mapping
