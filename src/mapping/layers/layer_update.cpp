// SPDX-License-Identifier: Apache-2.0
// Blocks are made from runs of cluxels of one tile; records follow from the shares that were written.
#include "mapping/layers/layer_update.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "cluxel/error.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// The cluxels of a tile: a run of the scene's.
struct Run {
  std::uint32_t begin = 0, end = 0;
};

std::map<TileKey, Run> runsOf(const perception::SceneCluxels& cluxels) {
  std::map<TileKey, Run> runs;
  for (std::uint32_t i = 0; i < cluxels.size(); ++i) {
    const auto run = runs.try_emplace(runs.end(), cluxels.name[i].tile, Run{i, i});
    run->second.end = i + 1;
  }
  return runs;
}

/// The layers of tiles of a scene.
class LayerMaker {
 public:
  explicit LayerMaker(const SceneLayers& layers) : layers_(layers), part_of_(layers.scene.cluxels.size(), kNoShare) {
    for (const rules::SemanticObject& object : layers.objects)
      for (const rules::ObjectPart& part : object.parts) {
        for (const std::uint32_t cluxel : part.cluxels) part_of_[cluxel] = static_cast<std::uint32_t>(parts_.size());
        parts_.push_back({&object, &part});
      }
  }

  TileLayer layerOf(const TileKey& key, const Run& run) const {
    TileLayer layer;
    layer.key = key;
    addPrimitives(run, layer);
    addShares(run, layer);
    return layer;
  }

 private:
  struct Part {
    const rules::SemanticObject* object;
    const rules::ObjectPart* part;
  };

  void addPrimitives(const Run& run, TileLayer& layer) const {
    const perception::SceneCluxels& cluxels = layers_.scene.cluxels;
    const Eigen::Vector3d corner = cornerOf(layer.key);
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const perception::PrimitiveIndex primitive = cluxels.primitive[i];
      if (cluxels.component[i] >= layer.primitives.size()) layer.primitives.resize(cluxels.component[i] + 1U);
      TileLayer::PrimitiveHere& here = layer.primitives[cluxels.component[i]];
      here.id = layers_.scene.primitives[primitive].id;
      if (!layers_.traces.empty()) here.trace = layers_.traces[primitive];
      if (!layers_.inputs.empty()) here.input = layers_.inputs[primitive];
      const Eigen::Vector3f low = (cluxels.low_corner[i] - corner).cast<float>();
      here.bounds.extend(low);
      here.bounds.extend(Eigen::Vector3f(low + cluxels.extent[i]));
    }
  }

  void addShares(const Run& run, TileLayer& layer) const {
    std::vector<std::uint32_t> present(part_of_.begin() + run.begin, part_of_.begin() + run.end);
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    if (!present.empty() && present.back() == kNoShare) present.pop_back();
    for (const std::uint32_t part : present)
      layer.shares.push_back({parts_[part].object->id, parts_[part].part->part_class, {}});
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      if (part_of_[i] == kNoShare) {
        layer.share_of_cluxel.push_back(kNoShare);
        continue;
      }
      const auto place = std::lower_bound(present.begin(), present.end(), part_of_[i]) - present.begin();
      layer.share_of_cluxel.push_back(static_cast<std::uint32_t>(place));
      layer.shares[static_cast<std::size_t>(place)].components.push_back(layers_.scene.cluxels.component[i]);
    }
    for (TileLayer::Share& share : layer.shares) {
      std::sort(share.components.begin(), share.components.end());
      share.components.erase(std::unique(share.components.begin(), share.components.end()), share.components.end());
    }
  }

  const SceneLayers& layers_;
  std::vector<Part> parts_;             ///< ascending by object and class
  std::vector<std::uint32_t> part_of_;  ///< by cluxel; kNoShare: none
};

void putIfChanged(rdf::WriteTransaction& transaction, std::string_view table, const std::string& key,
                  const std::string& bytes) {
  if (const auto old = transaction.block(table, key); old && *old == bytes) return;
  transaction.putBlock(table, key, bytes);
}

class LayerUpdate {
 public:
  LayerUpdate(rdf::WriteTransaction& transaction, const SceneLayers& layers)
      : transaction_(transaction), layers_(layers), maker_(layers), runs_(runsOf(layers.scene.cluxels)) {}

  void write(const TileSet& tiles) {
    for (const TileKey& tile : tiles) writeTile(tile);
    for (const auto& [object, now_in] : tiles_of_) writeRecord(object, now_in, tiles);
  }

 private:
  void writeTile(const TileKey& tile) {
    const std::string key = tables::keyOf(tile);
    const auto run = runs_.find(tile);
    if (const auto old = storedLayer(transaction_, tile))
      for (const TileLayer::Share& share : old->shares) tiles_of_[share.object];
    if (run == runs_.end()) {
      transaction_.eraseBlock(tables::kTileLayers, key);
      return;
    }
    const TileLayer layer = maker_.layerOf(tile, run->second);
    for (const TileLayer::Share& share : layer.shares) tiles_of_[share.object].insert(tile);
    putIfChanged(transaction_, tables::kTileLayers, key, toBytes(layer));
  }

  void writeRecord(const ContentHash& object, const TileSet& now_in, const TileSet& written) {
    const auto old = storedRecord(transaction_, object);
    ObjectRecord record = recordOf(object, old);
    TileSet all = now_in;
    if (old)
      for (const TileKey& tile : old->tiles)
        if (!written.contains(tile)) all.insert(tile);
    record.tiles.assign(all.begin(), all.end());
    const std::string key = tables::keyOf(object);
    if (all.empty())
      transaction_.eraseBlock(tables::kObjects, key);
    else
      putIfChanged(transaction_, tables::kObjects, key, toBytes(record));
  }

  /// What the scene's objects say, or what was stored of an object that is none of them.
  ObjectRecord recordOf(const ContentHash& id, const std::optional<ObjectRecord>& old) const {
    const auto found = std::lower_bound(layers_.objects.begin(), layers_.objects.end(), id,
                                        [](const auto& object, const ContentHash& key) { return object.id < key; });
    if (found == layers_.objects.end() || found->id != id) return old.value_or(ObjectRecord{});
    return {found->class_iri, found->rule_id, found->confidence, found->is_class_wide, {}};
  }

  rdf::WriteTransaction& transaction_;
  const SceneLayers& layers_;
  LayerMaker maker_;
  std::map<TileKey, Run> runs_;
  std::map<ContentHash, TileSet> tiles_of_;  ///< of objects in the written tiles before or now: where they are now
};

}  // namespace

void storeLayers(rdf::WriteTransaction& transaction, const SceneLayers& layers) {
  TileSet tiles;
  for (const auto& [tile, run] : runsOf(layers.scene.cluxels)) tiles.insert(tile);
  transaction.forEachBlock(tables::kTileLayers, "",
                           [&](std::string_view key, std::string_view) { tiles.insert(tables::tileOfKey(key)); });
  replaceLayers(transaction, layers, tiles);
}

void replaceLayers(rdf::WriteTransaction& transaction, const SceneLayers& layers, const TileSet& tiles) {
  LayerUpdate(transaction, layers).write(tiles);
}

}  // namespace cluxel::mapping
