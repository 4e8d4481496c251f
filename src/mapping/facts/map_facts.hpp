// SPDX-License-Identifier: Apache-2.0
// The observed graph: clouds, primitives with attributes and relations, objects with parts and observations as RDF.
#pragma once

#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "mapping/facts/fact_sink.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/layers/wide_tile.hpp"
#include "mapping/map_inputs.hpp"
#include "perception/segments/scene.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// A primitive lower than this above the ground touches it [m].
inline constexpr double kTouchesGround_m = 0.30;

/// The sources of the observed graph, of a whole map or of a window of it.
struct ObservedMap {
  const MapInputs& inputs;
  const std::vector<Cloud>& clouds;
  const perception::Scene& scene;
  const rules::ReasoningResult& reasoning;
  const std::map<std::pair<std::uint32_t, scan::ScanId>, Sighting>& sightings;
  /// By object; empty when presence is not asked for.
  const std::vector<std::optional<perception::Presence>>& presence;
  /// By object; empty when rays are not asked for.
  const std::vector<std::optional<perception::RayCounts>>& passed_rays;
  /// By object: the ids of those that are near.
  const std::vector<std::vector<ContentHash>>& near;
  /// What the tiles add to class-wide objects.
  const std::vector<WidePart>& wide;
  unsigned threads = 1;
};

/// The facts about the map, its clouds, its primitives and the ground that they touch.
void addSceneFacts(const MapInputs& inputs, const std::vector<Cloud>& clouds, const perception::Scene& scene,
                   FactSink& facts);

/// The facts about the map itself.
void addMap(const MapInputs& inputs, const std::vector<Cloud>& clouds, FactSink& facts);
void addCloud(const Cloud& cloud, FactSink& facts);
/// The facts of a primitive and its relations to others.
void addPrimitive(const perception::Scene& scene, perception::PrimitiveIndex number, FactSink& facts);
/// The ground patch that a primitive touches; absent when it touches none.
std::optional<std::string> touchedPatch(const perception::Scene& scene, perception::PrimitiveIndex number);
/// The unit of the facts of a ground patch.
FactUnitKey unitOfGroundPatch(std::string_view iri);

}  // namespace cluxel::mapping
