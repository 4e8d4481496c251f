// SPDX-License-Identifier: Apache-2.0
// A layer is made anew from its former one, where that still holds, and from the decision.
#include "mapping/window/window_layers.hpp"

#include <algorithm>
#include <tuple>

#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using perception::PrimitiveIndex;
using perception::TileKey;
using perception::TileSet;

class LayerWriting {
 public:
  LayerWriting(rdf::WriteTransaction& transaction, const DecidedWindow& decided, const OutputChanges& changes)
      : transaction_(transaction),
        window_(decided.window),
        decision_(decided.decision),
        changes_(changes),
        former_(decided.former),
        wide_(decided.wide),
        input_of_(decided.input_of),
        part_of_(decided.window.scene.cluxels.size(), kNoShare) {
    for (const rules::SemanticObject& object : decision_.objects)
      for (const rules::ObjectPart& part : object.parts) {
        for (const std::uint32_t cluxel : part.cluxels) part_of_[cluxel] = static_cast<std::uint32_t>(parts_.size());
        parts_.push_back({object.id, part.part_class});
      }
  }

  void run() {
    for (const TileKey& tile : window_.tiles) writeTile(tile);
    writeRecords();
  }

 private:
  struct Part {
    ContentHash object;
    std::string part_class;
    auto operator<=>(const Part&) const = default;
  };

  const perception::SceneCluxels& cluxels() const { return window_.scene.cluxels; }

  void writeTile(const TileKey& tile) {
    const std::string key = tables::keyOf(tile);
    const auto first = window_.first_cluxel.find(tile);
    if (first == window_.first_cluxel.end()) {
      transaction_.eraseBlock(tables::kTileLayers, key);
      return;
    }
    transaction_.putIfDifferent(tables::kTileLayers, key, toBytes(layerOf(tile, first->second)));
  }

  TileLayer layerOf(const TileKey& tile, std::uint32_t first) {
    const auto known = window_.layers.find(tile);
    const TileLayer* former = known == window_.layers.end() ? nullptr : &known->second;
    TileLayer layer;
    layer.key = tile;
    addPrimitives(former, layer);
    addShares(partsOf(tile, first, former), former, layer);
    return layer;
  }

  void addPrimitives(const TileLayer* former, TileLayer& layer) const {
    const bool is_changed = changes_.tiles.contains(layer.key);
    const std::vector<PrimitiveIndex>& now = window_.primitive_of_component.at(layer.key);
    for (std::size_t c = 0; c < now.size(); ++c) {
      const ContentHash& id = window_.scene.primitives[now[c]].id;
      if (!is_changed && decision_.is_decided[now[c]] == 0)
        layer.primitives.push_back(former->primitives[c]);
      else if (decision_.is_decided[now[c]] != 0)
        layer.primitives.push_back({id, input_of_(now[c]), decision_.traces[now[c]], {}});
      else
        layer.primitives.push_back({id, input_of_(now[c]), window_.known.at(id).trace, {}});
    }
    measure(layer);
  }

  /// Bounds of the primitives that have none yet.
  void measure(TileLayer& layer) const {
    const Eigen::Vector3d corner = cluxels().grid.cornerOf(layer.key);
    std::vector<char> has_bounds;
    for (const TileLayer::PrimitiveHere& here : layer.primitives) has_bounds.push_back(here.bounds.isEmpty() ? 0 : 1);
    for (std::uint32_t c = window_.first_cluxel.at(layer.key);
         c < cluxels().size() && cluxels().name[c].tile == layer.key; ++c) {
      if (has_bounds[cluxels().component[c]] != 0) continue;
      TileLayer::PrimitiveHere& here = layer.primitives[cluxels().component[c]];
      const Eigen::Vector3f low = (cluxels().low_corner[c] - corner).cast<float>();
      here.bounds.extend(low);
      here.bounds.extend(Eigen::Vector3f(low + cluxels().extent[c]));
    }
  }

  /// What each cluxel of a tile belongs to: a number in parts_, or beyond them one of the former shares, or kNoShare.
  std::vector<std::uint32_t> partsOf(const TileKey& tile, std::uint32_t first, const TileLayer* former) const {
    std::vector<std::uint32_t> parts;
    for (std::uint32_t c = first; c < cluxels().size() && cluxels().name[c].tile == tile; ++c) {
      if (decision_.is_decided[cluxels().primitive[c]] != 0) {
        parts.push_back(part_of_[c]);
        continue;
      }
      const bool is_known = former != nullptr && former_[c] != kNoFormer;
      const std::uint32_t share = is_known ? former->share_of_cluxel[former_[c]] : kNoShare;
      parts.push_back(share == kNoShare ? kNoShare : static_cast<std::uint32_t>(parts_.size()) + share);
    }
    return parts;
  }

  Part partOf(std::uint32_t number, const TileLayer* former) const {
    if (number < parts_.size()) return parts_[number];
    const TileLayer::Share& share = former->shares[number - parts_.size()];
    return {share.object, share.part_class};
  }

  /// A former share and a part that was decided can be the same.
  void addShares(const std::vector<std::uint32_t>& parts, const TileLayer* former, TileLayer& layer) {
    const std::uint32_t first = window_.first_cluxel.at(layer.key);
    std::vector<std::vector<std::uint32_t>> components(parts_.size() + (former != nullptr ? former->shares.size() : 0));
    for (std::uint32_t i = 0; i < parts.size(); ++i)
      if (parts[i] != kNoShare) components[parts[i]].push_back(cluxels().component[first + i]);
    std::map<Part, std::vector<std::uint32_t>> numbers;
    for (std::uint32_t number = 0; number < components.size(); ++number)
      if (!components[number].empty()) numbers[partOf(number, former)].push_back(number);
    std::vector<std::uint32_t> share_of(components.size(), kNoShare);
    for (const auto& [part, of_part] : numbers) {
      std::vector<std::uint32_t> own;
      for (const std::uint32_t number : of_part) {
        own.insert(own.end(), components[number].begin(), components[number].end());
        share_of[number] = static_cast<std::uint32_t>(layer.shares.size());
      }
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
      layer.shares.push_back({part.object, part.part_class, std::move(own)});
      tiles_of_[part.object].insert(layer.key);
    }
    for (const std::uint32_t part : parts)
      layer.share_of_cluxel.push_back(part == kNoShare ? kNoShare : share_of[part]);
  }

  void writeRecords() {
    for (const auto& [id, record] : decision_.replaced)
      if (!tiles_of_.contains(id)) transaction_.eraseBlock(tables::kObjects, tables::keyOf(id));
    for (const rules::SemanticObject& object : decision_.objects) {
      if (object.is_class_wide) continue;
      const TileSet& tiles = tiles_of_[object.id];
      put({object.class_iri, object.rule_id, object.confidence, false, {tiles.begin(), tiles.end()}}, object.id);
    }
    for (const rules::SemanticObject& object : wide_) writeWideRecord(object.id);
  }

  /// Of a class-wide object the tiles in the window are exchanged.
  void writeWideRecord(const ContentHash& id) {
    ObjectRecord record = storedRecord(transaction_, id).value();
    TileSet tiles = tiles_of_[id];
    for (const TileKey& tile : record.tiles)
      if (!window_.tiles.contains(tile)) tiles.insert(tile);
    record.tiles.assign(tiles.begin(), tiles.end());
    put(record, id);
  }

  void put(const ObjectRecord& record, const ContentHash& id) {
    transaction_.putBlock(tables::kObjects, tables::keyOf(id), toBytes(record));
  }

  rdf::WriteTransaction& transaction_;
  const MapWindow& window_;
  const WindowDecision& decision_;
  const OutputChanges& changes_;
  const std::vector<std::uint32_t>& former_;
  const std::vector<rules::SemanticObject>& wide_;
  const InputOf& input_of_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> part_of_;
  std::map<ContentHash, TileSet> tiles_of_;  ///< of objects, within the window
};

}  // namespace

void writeLayers(rdf::WriteTransaction& transaction, const DecidedWindow& decided, const OutputChanges& changes) {
  LayerWriting(transaction, decided, changes).run();
}

}  // namespace cluxel::mapping
