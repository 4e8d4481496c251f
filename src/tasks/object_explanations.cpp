// SPDX-License-Identifier: Apache-2.0
// Objects are explained with the region of their first tile. Who needs more around it is explained in a second round.
#include "tasks/object_explanations.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/free_memory.hpp"
#include "base/sorting/temporary_bytes.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_part.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/tile_regions.hpp"
#include "mapping/splits_store.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "perception/segments/summary_tile.hpp"
#include "rules/explain/part_run.hpp"
#include "tasks/explanation.hpp"
#include "tasks/explanation_names.hpp"

namespace cluxel::tasks {

namespace {

using perception::TileKey;
using perception::TileSet;

std::size_t cluxelsOf(const mapping::MapReader& map, const TileKey& tile) {
  return perception::cluxelsIn(mapping::requiredBlock(map.transaction(), mapping::tables::kSummaries, tile));
}

/// An object of the map that is explained by a region.
struct RegionalObject {
  ContentHash id, id_by_rules;
  std::vector<TileKey> tiles;
  std::optional<std::pair<std::uint64_t, std::size_t>> line;  ///< place and size in the file
};

class RegionalExplanations {
 public:
  explicit RegionalExplanations(const mapping::MapReader& map)
      : map_(map),
        inputs_(map.inputs()),
        rules_(mapping::parseInputs(inputs_).rules),
        all_tiles_(mapping::storedTiles(map.transaction())),
        splits_(mapping::storedSplitsIfFew(map.transaction())) {
    std::map<ContentHash, ContentHash> by_rules;
    for (const mapping::OverruledObject& overruled : map.overruled())
      if (overruled.now) by_rules[*overruled.now] = overruled.by_rules.id;
    mapping::forEachRecord(map.transaction(), [&](const ContentHash& id, const mapping::ObjectRecord& record) {
      if (record.tiles.empty()) mapping::refuseDamaged("an object has no cluxels");
      const auto made = by_rules.find(id);
      objects_.push_back({id, made == by_rules.end() ? id : made->second, record.tiles, std::nullopt});
      if (record.is_class_wide) keep(objects_.size() - 1, explainObject(map, objects_.size() - 1));
    });
  }

  /// With so many rings of tiles around the objects of each region.
  void explain(int rings, std::size_t max_cluxels) {
    std::map<TileKey, std::vector<std::size_t>> begin_in;
    for (std::size_t i = 0; i < objects_.size(); ++i)
      if (!objects_[i].line) begin_in[objects_[i].tiles.front()].push_back(i);
    std::vector<mapping::CountedTile> tiles;
    for (const auto& [tile, objects] : begin_in) tiles.push_back({tile, cluxelsOf(map_, tile)});
    for (const TileSet& region : mapping::regionsOf(std::move(tiles), max_cluxels)) {
      std::vector<std::size_t> objects;
      for (const TileKey& tile : region)
        objects.insert(objects.end(), begin_in.at(tile).begin(), begin_in.at(tile).end());
      explainTogether(objects, rings);
      returnFreeMemory();
    }
  }

  /// What no region told is told by the whole map.
  void visit(const std::function<void(std::string_view)>& visit) {
    std::vector<std::string> whole;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      if (!objects_[i].line && whole.empty()) whole = explainObjects(map_);
      if (!objects_[i].line) {
        visit(whole[i]);
        continue;
      }
      std::string line(objects_[i].line->second, '\0');
      lines_.read(objects_[i].line->first, line.data(), line.size());
      visit(line);
    }
  }

 private:
  void keep(std::size_t object, const std::string& line) { objects_[object].line = {lines_.append(line), line.size()}; }

  void explainTogether(const std::vector<std::size_t>& objects, int rings) {
    TileSet tiles;
    for (const std::size_t i : objects) tiles.insert(objects_[i].tiles.begin(), objects_[i].tiles.end());
    for (int ring = 0; ring < rings; ++ring) tiles = perception::withRing(tiles, all_tiles_);
    mapping::TileStages stages(map_.model(), inputs_.params);
    constexpr double whole_map = 2;  // any share
    auto part = mapping::partOfMap(map_.transaction(), stages, tiles, 0, whole_map);
    if (!part) return;
    stages.dropAll();
    part = withObjectsByRules(map_, *std::move(part));
    rules::KnownSplits splits = splits_;
    const auto explanations =
        explainInPart(part->scene, rules_, {part->traces, part->objects, &splits}, askedAbout(objects, *part));
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!explanations[i]) continue;
      rules::Explanation explanation = *explanations[i];
      shortenFiles(explanation, inputs_);
      keep(objects[i], nlohmann::ordered_json::parse(jsonOf(explanation, rules_, part->scene)).dump());
    }
  }

  std::vector<rules::AskedObject> askedAbout(const std::vector<std::size_t>& objects,
                                             const mapping::MapPart& part) const {
    std::vector<rules::AskedObject> asked;
    for (const std::size_t i : objects) {
      const auto here = std::lower_bound(part.objects.begin(), part.objects.end(), objects_[i].id,
                                         [](const auto& object, const ContentHash& id) { return object.id < id; });
      asked.push_back({objects_[i].id_by_rules, {}});
      if (here != part.objects.end() && here->id == objects_[i].id) asked.back().primitives = primitivesOf(*here);
    }
    return asked;
  }

  const mapping::MapReader& map_;
  mapping::MapInputs inputs_;
  rules::RuleSet rules_;
  TileSet all_tiles_;
  rules::KnownSplits splits_;
  std::vector<RegionalObject> objects_;
  TemporaryBytes lines_;
};

bool isExplainedAtOnce(const mapping::MapReader& map, const ExplainedCluxels& most) {
  std::size_t cluxels = 0;
  for (const TileKey& tile : mapping::storedTiles(map.transaction())) cluxels += cluxelsOf(map, tile);
  return cluxels <= most.whole || mapping::parseInputs(map.inputs()).rules.asks_map;
}

}  // namespace

void forEachExplanation(const mapping::MapReader& map, const std::function<void(std::string_view)>& visit,
                        const ExplainedCluxels& most) {
  if (isExplainedAtOnce(map, most)) {
    for (const std::string& line : explainObjects(map)) visit(line);
    return;
  }
  RegionalExplanations explanations(map);
  explanations.explain(2, most.region);
  explanations.explain(4, most.region / 4);
  explanations.visit(visit);
}

}  // namespace cluxel::tasks
