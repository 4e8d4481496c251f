// SPDX-License-Identifier: Apache-2.0
// Facts about objects, their parts, and the observations of them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "mapping/facts/fact_patch.hpp"
#include "mapping/facts/map_facts.hpp"

namespace cluxel::mapping {

void addObjectFacts(const ObservedMap& map, FactSink& facts);

/// When it was there, and how many rays passed it.
void addRayFacts(rdf::TermId subject, const std::optional<perception::Presence>& presence,
                 const std::optional<perception::RayCounts>& passed_rays, FactSink& facts);
/// The same, in place of what the patched graph tells.
void replaceRayFacts(rdf::TermId subject, const std::optional<perception::Presence>& presence,
                     const std::optional<perception::RayCounts>& passed_rays, FactPatch& patch, FactSink& facts);

/// x, y, z [m, map].
void addPosition(rdf::TermId subject, const Eigen::Vector3d& p_map, FactSink& facts);
/// minX … maxZ [m, map].
void addBounds(rdf::TermId subject, const Eigen::Vector3d& min, const Eigen::Vector3d& max, FactSink& facts);

}  // namespace cluxel::mapping
