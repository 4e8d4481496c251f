// SPDX-License-Identifier: Apache-2.0
// The observed graph: clouds, primitives with attributes and relations, objects with parts and observations as RDF.
#pragma once

#include <map>
#include <vector>

#include "cluxel/mapping/cloud.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/perception/scene.hpp"
#include "cluxel/reasoning/semantic_object.hpp"
#include "mapping/fact_sink.hpp"
#include "mapping/object_geometry.hpp"

namespace cluxel {

/// Objects closer than this are clx:near each other [m].
inline constexpr double kNearObjects_m = 1.0;
/// A primitive lower than this above the ground touches it [m].
inline constexpr double kTouchesGround_m = 0.30;

/// All that the observed graph is made of.
struct ObservedMap {
  const MapInputs& inputs;
  const std::vector<Cloud>& clouds;
  const Scene& scene;
  const ReasoningResult& reasoning;
  const std::map<std::pair<std::uint32_t, ScanId>, Sighting>& sightings;
};

void addObservedFacts(const ObservedMap& map, FactSink& facts);

std::string iriOfCloud(const ScanId& id);
std::string iriOfPrimitive(const ContentHash& id);
std::string iriOfObject(const ContentHash& id);
/// xsd:dateTime in UTC of seconds since 1970.
std::string dateTimeText(double time_s);

}  // namespace cluxel
