// SPDX-License-Identifier: Apache-2.0
// Blocks are made from runs of cluxels of one tile; records follow from the shares that were written.
#include "mapping/layers/layer_update.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
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

  LayerBlock blockOf(const TileKey& key, const Run& run) const {
    TileLayer layer;
    layer.key = key;
    addPrimitives(run, layer);
    addShares(run, layer);
    LayerBlock block{toBytes(layer), {}};
    for (const TileLayer::Share& share : layer.shares)
      if (block.objects.empty() || block.objects.back() != share.object) block.objects.push_back(share.object);
    return block;
  }

 private:
  struct Part {
    const rules::SemanticObject* object;
    const rules::ObjectPart* part;
  };

  void addPrimitives(const Run& run, TileLayer& layer) const {
    const perception::SceneCluxels& cluxels = layers_.scene.cluxels;
    const Eigen::Vector3d corner = cluxels.grid.cornerOf(layer.key);
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

LayerBlocks blocksOf(const SceneLayers& layers, const std::map<TileKey, Run>& runs, unsigned threads) {
  const LayerMaker maker(layers);
  LayerBlocks blocks;
  std::vector<std::pair<const Run*, LayerBlocks::iterator>> places;
  places.reserve(runs.size());
  for (const auto& [tile, run] : runs) places.emplace_back(&run, blocks.emplace(tile, LayerBlock{}).first);
  parallelFor(places.size(), threads, [&](std::size_t i) {
    const auto& [run, block] = places[i];
    block->second = maker.blockOf(block->first, *run);
  });
  return blocks;
}

class LayerUpdate {
 public:
  LayerUpdate(rdf::WriteTransaction& transaction, const SceneLayers& layers, const LayerBlocks& blocks)
      : transaction_(transaction), layers_(layers), blocks_(blocks) {}

  void write(const TileSet& tiles) {
    for (const TileKey& tile : tiles) writeTile(tile);
    for (const auto& [object, now_in] : tiles_of_) writeRecord(object, now_in, tiles);
  }

 private:
  void writeTile(const TileKey& tile) {
    const std::string key = tables::keyOf(tile);
    const auto block = blocks_.find(tile);
    if (const auto old = storedLayer(transaction_, tile))
      for (const TileLayer::Share& share : old->shares) tiles_of_[share.object];
    if (block == blocks_.end()) {
      transaction_.eraseBlock(tables::kTileLayers, key);
      return;
    }
    for (const ContentHash& object : block->second.objects) tiles_of_[object].insert(tile);
    transaction_.putIfDifferent(tables::kTileLayers, key, block->second.bytes);
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
      transaction_.putIfDifferent(tables::kObjects, key, toBytes(record));
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
  const LayerBlocks& blocks_;
  std::map<ContentHash, TileSet> tiles_of_;  ///< of objects in the written tiles before or now: where they are now
};

}  // namespace

LayerBlocks layerBlocks(const SceneLayers& layers, unsigned threads) {
  return blocksOf(layers, runsOf(layers.scene.cluxels), threads);
}

void storeLayers(rdf::WriteTransaction& transaction, const SceneLayers& layers, const LayerBlocks& blocks) {
  TileSet tiles;
  for (const auto& [tile, block] : blocks) tiles.insert(tile);
  transaction.forEachBlock(tables::kTileLayers, "",
                           [&](std::string_view key, std::string_view) { tiles.insert(tables::tileOfKey(key)); });
  LayerUpdate(transaction, layers, blocks).write(tiles);
}

void replaceLayers(rdf::WriteTransaction& transaction, const SceneLayers& layers, const TileSet& tiles) {
  std::map<TileKey, Run> runs = runsOf(layers.scene.cluxels);
  std::erase_if(runs, [&](const auto& entry) { return !tiles.contains(entry.first); });
  LayerUpdate(transaction, layers, blocksOf(layers, runs, 1)).write(tiles);
}

}  // namespace cluxel::mapping
