// SPDX-License-Identifier: Apache-2.0
// Undecided cluxels belong to what they belonged to.
#include "mapping/window/kept_objects.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/layers/stored_layers.hpp"

namespace cluxel::mapping {

namespace {

/// The share of an undecided cluxel before the change; null for none.
const TileLayer::Share* formerShare(const MapWindow& window, const WindowDecision& decision,
                                    const std::vector<std::uint32_t>& former, std::uint32_t cluxel) {
  const perception::SceneCluxels& all = window.scene.cluxels;
  if (decision.is_decided[all.primitive[cluxel]] != 0 || former[cluxel] == kNoFormer) return nullptr;
  const auto layer = window.layers.find(all.name[cluxel].tile);
  if (layer == window.layers.end()) return nullptr;
  const std::uint32_t share = layer->second.share_of_cluxel[former[cluxel]];
  return share == kNoShare ? nullptr : &layer->second.shares[share];
}

bool isInside(const ObjectRecord& record, const MapWindow& window) {
  return !record.is_class_wide && std::all_of(record.tiles.begin(), record.tiles.end(),
                                              [&](const auto& tile) { return window.first_cluxel.contains(tile); });
}

}  // namespace

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
  for (std::uint32_t c = 0; c < owners.owner_of.size(); ++c)
    if (const TileLayer::Share* share = formerShare(window, decision, former, c))
      owners.owner_of[c] = numberOf(share->object);
  return owners;
}

namespace {

using PartsByClass = std::map<std::string, std::vector<std::uint32_t>>;  ///< cluxels by part class

std::map<ContentHash, PartsByClass> formerParts(const MapWindow& window, const WindowDecision& decision,
                                                const std::vector<std::uint32_t>& former) {
  std::map<ContentHash, PartsByClass> parts;
  for (std::uint32_t c = 0; c < former.size(); ++c)
    if (const TileLayer::Share* share = formerShare(window, decision, former, c))
      parts[share->object][share->part_class].push_back(c);
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
  for (const rules::SemanticObject& object : decision.objects)
    for (const rules::ObjectPart& part : object.parts) {
      std::vector<std::uint32_t>& own = parts[object.id][part.part_class];
      own.insert(own.end(), part.cluxels.begin(), part.cluxels.end());
    }
  for (const auto& [tile, layer] : window.layers)
    for (const TileLayer::Share& share : layer.shares) parts.try_emplace(share.object);
  std::vector<rules::SemanticObject> wide;
  for (auto& [id, of_object] : parts) {
    const std::optional<ObjectRecord> record = storedRecord(transaction, id);
    if (record && record->is_class_wide) wide.push_back(objectOf(id, *record, std::move(of_object)));
  }
  return wide;
}

}  // namespace cluxel::mapping
