// SPDX-License-Identifier: Apache-2.0
// Facts about objects, their parts, and the observations of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "mapping/facts/map_facts.hpp"

namespace cluxel::mapping {

void addObjectFacts(const ObservedMap& map, FactSink& facts);

/// The properties of an object that follow from rays.
inline constexpr std::array<std::string_view, 6> kRayProperties{"firstSeen",   "lastSeen", "seenEmpty",
                                                                "seenThrough", "porosity", "rayCount"};
/// When it was there, and how many rays passed it.
void addRayFacts(rdf::TermId subject, const std::optional<perception::Presence>& presence,
                 const std::optional<perception::RayCounts>& passed_rays, FactSink& facts);

/// x, y, z [m, map].
void addPosition(rdf::TermId subject, const Eigen::Vector3d& p_map, FactSink& facts);
/// minX … maxZ [m, map].
void addBounds(rdf::TermId subject, const Eigen::Vector3d& min, const Eigen::Vector3d& max, FactSink& facts);

}  // namespace cluxel::mapping
