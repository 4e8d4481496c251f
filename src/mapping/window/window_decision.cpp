// SPDX-License-Identifier: Apache-2.0
// The rules' local run tells how far the change reaches; former objects are found by the shares of the tiles.
#include "mapping/window/window_decision.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "mapping/layers/primitive_tiles.hpp"
#include "mapping/layers/stored_layers.hpp"

namespace cluxel::mapping {

namespace {

using perception::PrimitiveIndex;
using perception::TileKey;
using perception::TileSet;

class Deciding {
 public:
  Deciding(const MapWindow& window, const WindowChange& change, const rdf::ReadTransaction& transaction)
      : window_(window), change_(change), transaction_(transaction) {
    for (PrimitiveIndex i = 0; i < window.scene.primitives.size(); ++i)
      number_.emplace(window.scene.primitives[i].id, i);
  }

  /// An object with a decided part must be known as a whole. Where it is not, its other parts count as changed, too.
  std::optional<WindowDecision> take(rules::LocalRun& run, TileSet& lacking) {
    for (bool is_found = run.decide(); is_found; is_found = run.decideWith(unsure_)) {
      unsure_.clear();
      layer_ = run.layers();
      WindowDecision decision = decided(run.result());
      if (!findReplaced(decision, lacking) || !lacking.empty()) break;
      if (unsure_.empty()) return decision;
    }
    return std::nullopt;
  }

 private:
  WindowDecision decided(const rules::ReasoningResult& result) {
    WindowDecision decision;
    decision.traces = result.traces;
    for (const std::uint32_t layer : layer_) decision.is_decided.push_back(layer <= rules::kLastDecidedLayer ? 1 : 0);
    for (const rules::SemanticObject& object : result.objects) {
      if (!hasDecided(object, decision.is_decided)) continue;
      if (!object.is_class_wide) noteUnsure(object);
      keepDecided(object, decision);
    }
    return decision;
  }

  static bool hasDecided(const rules::SemanticObject& object, const std::vector<char>& is_decided) {
    return std::any_of(object.parts.begin(), object.parts.end(), [&](const rules::ObjectPart& part) {
      return std::any_of(part.primitives.begin(), part.primitives.end(),
                         [&](PrimitiveIndex primitive) { return is_decided[primitive] != 0; });
    });
  }

  void noteUnsure(const rules::SemanticObject& object) {
    for (const rules::ObjectPart& part : object.parts)
      for (const PrimitiveIndex primitive : part.primitives)
        if (layer_[primitive] == rules::kNoLayer) unsure_.push_back(primitive);
  }

  void keepDecided(rules::SemanticObject object, WindowDecision& decision) const {
    if (object.is_class_wide)
      for (rules::ObjectPart& part : object.parts) {
        std::erase_if(part.primitives, [&](PrimitiveIndex primitive) { return decision.is_decided[primitive] == 0; });
        std::erase_if(part.cluxels, [&](std::uint32_t cluxel) {
          return decision.is_decided[window_.scene.cluxels.primitive[cluxel]] == 0;
        });
      }
    decision.objects.push_back(std::move(object));
  }

  /// Whether the primitive is gone or decided anew; by the id that it had before.
  bool isConcerned(const ContentHash& primitive, const WindowDecision& decision) const {
    if (change_.gone.contains(primitive)) return true;
    const auto now = number_.find(primitive);
    return now != number_.end() && decision.is_decided[now->second] != 0;
  }
  /// Former objects of what is decided. What they have beyond the layers is not known, and what lies beyond the window
  /// is lacking. False when the map has no record of one.
  bool findReplaced(WindowDecision& decision, TileSet& lacking) {
    std::map<ContentHash, std::vector<std::pair<TileKey, ContentHash>>> parts;  // primitives of objects, by tile
    std::set<ContentHash> concerned;
    for (const auto& [tile, layer] : window_.layers)
      for (const TileLayer::Share& share : layer.shares)
        for (const std::uint32_t component : share.components) {
          const ContentHash& primitive = layer.primitives[component].id;
          if (isConcerned(primitive, decision)) concerned.insert(share.object);
          if (!isKnown(primitive)) parts[share.object].emplace_back(tile, primitive);
        }
    PrimitiveTiles tiles(transaction_);
    const auto is_inside = [&](const TileKey& tile) { return window_.tiles.contains(tile); };
    for (const ContentHash& id : concerned) {
      const std::optional<ObjectRecord> record = storedRecord(transaction_, id);
      if (!record) return false;
      if (record->is_class_wide) continue;
      std::copy_if(record->tiles.begin(), record->tiles.end(), std::inserter(lacking, lacking.end()),
                   [&](const TileKey& tile) { return !is_inside(tile); });
      for (const auto& [tile, primitive] : parts[id]) {
        if (const auto now = number_.find(primitive); now != number_.end())
          unsure_.push_back(now->second);
        else
          lacking.merge(tiles.beyond({tile}, {primitive}, is_inside));  // it is cut
      }
      decision.replaced.emplace(id, *record);
    }
    return true;
  }

  /// Whether it is gone, or its outcome in this run is that of a run over the whole map.
  bool isKnown(const ContentHash& primitive) const {
    if (change_.gone.contains(primitive)) return true;
    const auto now = number_.find(primitive);
    return now != number_.end() && layer_[now->second] != rules::kNoLayer;
  }

  const MapWindow& window_;
  const WindowChange& change_;
  const rdf::ReadTransaction& transaction_;
  std::map<ContentHash, PrimitiveIndex> number_;
  std::vector<std::uint32_t> layer_;
  std::vector<PrimitiveIndex> unsure_;  ///< beyond the layers, though objects tie it to what is decided
};

/// By primitive: whether it was part of an object that strata of lone seeds made.
std::vector<char> wereTakenAlone(const MapWindow& window, const std::set<ContentHash>& objects) {
  std::set<ContentHash> taken;
  for (const auto& [tile, layer] : window.layers)
    for (const TileLayer::Share& share : layer.shares)
      if (objects.contains(share.object))
        for (const std::uint32_t component : share.components) taken.insert(layer.primitives[component].id);
  std::vector<char> were;
  for (const perception::Primitive& primitive : window.scene.primitives)
    were.push_back(taken.contains(primitive.id) ? 1 : 0);
  return were;
}

}  // namespace

rules::LocalInput localInputOf(const MapWindow& window, const WindowChange& change,
                               const std::set<ContentHash>& lone_objects, double reach_m) {
  rules::LocalInput input{window.scene, change.is_dirty, change.is_open, change.gone_boxes, {}};
  input.likely.is_fixed = wereTakenAlone(window, lone_objects);
  input.likely.layers =
      rules::layersAround(window.scene, change.is_dirty, input.likely.is_fixed, change.gone_boxes, reach_m);
  for (const perception::Primitive& primitive : window.scene.primitives) {
    const auto known = window.known.find(primitive.id);
    input.stored_trace.push_back(known == window.known.end() ? std::nullopt : std::optional(known->second.trace));
  }
  return input;
}

TileSet tilesBeyond(const MapWindow& window, const WindowChange& change, const OutputChanges& changes,
                    const rdf::ReadTransaction& transaction, const std::vector<std::uint32_t>& layers) {
  const auto isShort = [&](PrimitiveIndex i) { return layers[i] != rules::kNoLayer && change.is_open[i] != 0; };
  PrimitiveTiles tiles(transaction);
  const auto is_inside = [&](const TileKey& tile) { return window.first_cluxel.contains(tile); };
  TileSet beyond;
  for (const auto& [tile, layer] : window.layers) {
    const auto now = window.primitive_of_component.find(tile);
    if (now == window.primitive_of_component.end() || changes.tiles.contains(tile)) continue;
    for (std::size_t c = 0; c < now->second.size() && c < layer.primitives.size(); ++c)
      if (isShort(now->second[c]) && window.is_cut[now->second[c]] != 0)
        beyond.merge(tiles.beyond({tile}, {layer.primitives[c].id}, is_inside));
  }
  const perception::SceneCluxels& all = window.scene.cluxels;
  for (std::uint32_t c = 0; c < all.size(); ++c)
    if (isShort(all.primitive[c]))
      for (const TileKey& near : perception::ringOf(all.name[c].tile))
        if (window.elsewhere.contains(near)) beyond.insert(near);
  return beyond;
}

std::optional<WindowDecision> decideIn(const MapWindow& window, const WindowChange& change,
                                       const rdf::ReadTransaction& transaction, rules::LocalRun& run,
                                       TileSet& lacking) {
  return Deciding(window, change, transaction).take(run, lacking);
}

}  // namespace cluxel::mapping
