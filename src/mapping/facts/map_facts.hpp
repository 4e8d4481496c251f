// SPDX-License-Identifier: Apache-2.0
// The observed graph: clouds, primitives with attributes and relations, objects with parts and observations as RDF.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "mapping/cloud.hpp"
#include "mapping/facts/fact_sink.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_inputs.hpp"
#include "perception/segments/scene.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// Objects closer than this are clx:near each other [m].
inline constexpr double kNearObjects_m = 1.0;
/// A primitive lower than this above the ground touches it [m].
inline constexpr double kTouchesGround_m = 0.30;

/// The sources of the observed graph.
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
};

void addObservedFacts(const ObservedMap& map, FactSink& facts);

}  // namespace cluxel::mapping
