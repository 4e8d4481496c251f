// SPDX-License-Identifier: Apache-2.0
// Finds the owners of cluxels after a change: undecided cluxels keep their former owner.
#include "mapping/window/kept_objects.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/layers/stored_layers.hpp"

namespace cluxel::mapping {

namespace {

/// Calls visit(cluxel, layer, number of a share) for each undecided cluxel that belonged to an object before the
/// change.
template <typename Visit>
void forEachKept(const MapWindow& window, const WindowDecision& decision, const std::vector<std::uint32_t>& former,
                 const Visit& visit) {
  const perception::SceneCluxels& all = window.scene.cluxels;
  for (const auto& [tile, first] : window.first_cluxel) {
    const auto layer = window.layers.find(tile);
    if (layer == window.layers.end()) continue;
    for (std::uint32_t c = first; c < all.size() && all.name[c].tile == tile; ++c) {
      if (decision.is_decided[all.primitive[c]] != 0 || former[c] == kNoFormer) continue;
      if (const std::uint32_t share = layer->second.share_of_cluxel[former[c]]; share != kNoShare)
        visit(c, layer->second, share);
    }
  }
}

}  // namespace

bool isInside(const ObjectRecord& record, const MapWindow& window) {
  return !record.is_class_wide && std::all_of(record.tiles.begin(), record.tiles.end(),
                                              [&](const auto& tile) { return window.first_cluxel.contains(tile); });
}

WindowOwners ownersIn(const MapWindow& window, const WindowDecision& decision,
                      const std::vector<std::uint32_t>& former) {
  WindowOwners owners;
  owners.owner_of.assign(window.scene.cluxels.size(), kNoObject);
  std::unordered_map<ContentHash, std::uint32_t> number;
  const auto numberOf = [&](const ContentHash& object) {
    const auto [place, is_new] = number.try_emplace(object, static_cast<std::uint32_t>(owners.objects.size()));
    if (is_new) owners.objects.push_back(object);
    return place->second;
  };
  for (const rules::SemanticObject& object : decision.objects)
    for (const rules::ObjectPart& part : object.parts)
      for (const std::uint32_t cluxel : part.cluxels) owners.owner_of[cluxel] = numberOf(object.id);
  forEachKept(window, decision, former, [&](std::uint32_t cluxel, const TileLayer& layer, std::uint32_t share) {
    owners.owner_of[cluxel] = numberOf(layer.shares[share].object);
  });
  return owners;
}

namespace {

using PartsByClass = std::map<std::string, std::vector<std::uint32_t>>;  ///< cluxels by part class

std::map<ContentHash, PartsByClass> formerParts(const MapWindow& window, const WindowDecision& decision,
                                                const std::vector<std::uint32_t>& former) {
  std::map<ContentHash, PartsByClass> parts;
  const TileLayer* last = nullptr;
  std::vector<std::vector<std::uint32_t>*> of_share;  // of the layer at hand
  forEachKept(window, decision, former, [&](std::uint32_t cluxel, const TileLayer& layer, std::uint32_t share) {
    if (std::exchange(last, &layer) != &layer) of_share.assign(layer.shares.size(), nullptr);
    const TileLayer::Share& of = layer.shares[share];
    if (of_share[share] == nullptr) of_share[share] = &parts[of.object][of.part_class];
    of_share[share]->push_back(cluxel);
  });
  return parts;
}

rules::SemanticObject objectOf(const ContentHash& id, const ObjectRecord& record, PartsByClass parts) {
  rules::SemanticObject object;
  object.id = id;
  object.class_iri = record.class_iri, object.rule_id = record.rule_id, object.confidence = record.confidence;
  object.is_class_wide = record.is_class_wide;
  for (auto& [name, cluxels] : parts) {
    std::sort(cluxels.begin(), cluxels.end());
    object.parts.push_back({name, {}, std::move(cluxels)});
  }
  return object;
}

}  // namespace

std::vector<rules::SemanticObject> keptObjects(const rdf::ReadTransaction& transaction, const MapWindow& window,
                                               const WindowDecision& decision,
                                               const std::vector<std::uint32_t>& former) {
  std::map<ContentHash, PartsByClass> parts = formerParts(window, decision, former);
  for (const rules::SemanticObject& object : decision.objects) parts.erase(object.id);
  std::vector<rules::SemanticObject> kept;
  for (auto& [id, of_object] : parts) {
    const std::optional<ObjectRecord> record = storedRecord(transaction, id);
    if (!record || decision.replaced.contains(id) || !isInside(*record, window)) continue;
    kept.push_back(objectOf(id, *record, std::move(of_object)));
  }
  return kept;
}

std::vector<rules::SemanticObject> wideObjectsIn(const rdf::ReadTransaction& transaction, const MapWindow& window,
                                                 const WindowDecision& decision,
                                                 const std::vector<std::uint32_t>& former) {
  std::map<ContentHash, PartsByClass> parts = formerParts(window, decision, former);
  for (const rules::SemanticObject& object : decision.objects) {
    if (!object.is_class_wide) continue;
    for (const rules::ObjectPart& part : object.parts) {
      std::vector<std::uint32_t>& own = parts[object.id][part.part_class];
      own.insert(own.end(), part.cluxels.begin(), part.cluxels.end());
    }
  }
  for (const auto& [tile, layer] : window.layers)
    for (const TileLayer::Share& share : layer.shares) parts.try_emplace(share.object);
  std::vector<rules::SemanticObject> wide;
  for (auto& [id, of_object] : parts) {
    if (decision.replaced.contains(id)) continue;
    const std::optional<ObjectRecord> record = storedRecord(transaction, id);
    if (record && record->is_class_wide) wide.push_back(objectOf(id, *record, std::move(of_object)));
  }
  return wide;
}

}  // namespace cluxel::mapping
