// SPDX-License-Identifier: Apache-2.0
// The rules' local run tells how far the change reaches; former objects are found by the shares of the tiles.
#include "mapping/window/window_decision.hpp"

#include <algorithm>

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

  /// Objects may reach across the nearest seam: then a farther one may do.
  std::optional<WindowDecision> take(std::optional<rules::LocalOutcome> outcome) {
    if (!outcome) return std::nullopt;
    layer_ = std::move(outcome->layer);
    if (outcome->seams.empty()) outcome->seams.push_back({0, 0});
    for (const rules::Seam& seam : outcome->seams) {
      seam_ = seam;
      if (auto decision = takeUpToSeam(outcome->result)) return decision;
    }
    return std::nullopt;
  }

 private:
  std::optional<WindowDecision> takeUpToSeam(const rules::ReasoningResult& result) {
    WindowDecision decision;
    decision.traces = result.traces;
    for (const std::uint32_t layer : layer_) decision.is_decided.push_back(layer <= seam_.first ? 1 : 0);
    for (const rules::SemanticObject& object : result.objects) {
      if (!hasDecided(object, decision.is_decided)) continue;
      if (!object.is_class_wide && !isSureAsAWhole(object)) return std::nullopt;
      keepDecided(object, decision);
    }
    if (!findReplaced(decision)) return std::nullopt;
    return decision;
  }

  static bool hasDecided(const rules::SemanticObject& object, const std::vector<char>& is_decided) {
    return std::any_of(object.parts.begin(), object.parts.end(), [&](const rules::ObjectPart& part) {
      return std::any_of(part.primitives.begin(), part.primitives.end(),
                         [&](PrimitiveIndex primitive) { return is_decided[primitive] != 0; });
    });
  }

  bool isSureAsAWhole(const rules::SemanticObject& object) const {
    return std::all_of(object.parts.begin(), object.parts.end(), [&](const rules::ObjectPart& part) {
      return std::all_of(part.primitives.begin(), part.primitives.end(), [&](PrimitiveIndex primitive) {
        return layer_[primitive] <= seam_.last && change_.is_open[primitive] == 0;
      });
    });
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
  /// Whether its outcome in this run is known to be that of a run over the whole map.
  bool isSure(const ContentHash& primitive) const {
    if (change_.gone.contains(primitive)) return true;
    const auto now = number_.find(primitive);
    return now != number_.end() && layer_[now->second] <= seam_.last;
  }

  /// False when an object reaches out of what is sure.
  bool findReplaced(WindowDecision& decision) const {
    std::map<ContentHash, bool> is_sure;
    std::set<ContentHash> concerned;
    for (const auto& [tile, layer] : window_.layers)
      for (const TileLayer::Share& share : layer.shares)
        for (const std::uint32_t component : share.components) {
          const ContentHash& primitive = layer.primitives[component].id;
          if (isConcerned(primitive, decision)) concerned.insert(share.object);
          bool& sure = is_sure.try_emplace(share.object, true).first->second;
          sure = sure && isSure(primitive);
        }
    for (const ContentHash& id : concerned) {
      const std::optional<ObjectRecord> record = storedRecord(transaction_, id);
      if (!record) return false;
      if (record->is_class_wide) continue;
      const bool is_inside = std::all_of(record->tiles.begin(), record->tiles.end(),
                                         [&](const auto& tile) { return window_.tiles.contains(tile); });
      if (!is_inside || !is_sure.at(id)) return false;
      decision.replaced.emplace(id, *record);
    }
    return true;
  }

  const MapWindow& window_;
  const WindowChange& change_;
  const rdf::ReadTransaction& transaction_;
  std::map<ContentHash, PrimitiveIndex> number_;
  std::vector<std::uint32_t> layer_;
  rules::Seam seam_;  ///< layers up to its first are decided anew; up to its last the outcome is known
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
                    const rdf::ReadTransaction& transaction, const std::vector<std::uint32_t>& layers,
                    std::uint32_t depth) {
  const auto isShort = [&](PrimitiveIndex i) { return layers[i] < depth && change.is_open[i] != 0; };
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
                                       const rdf::ReadTransaction& transaction, rules::LocalRun& run) {
  return Deciding(window, change, transaction).take(run.decide());
}

}  // namespace cluxel::mapping
