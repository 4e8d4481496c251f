// SPDX-License-Identifier: Apache-2.0
// Facts about objects, their parts, and the observations of them.
#pragma once

#include <Eigen/Core>

#include "mapping/facts/map_facts.hpp"

namespace cluxel::mapping {

void addObjectFacts(const ObservedMap& map, FactSink& facts);

/// x, y, z [m, map].
void addPosition(rdf::TermId subject, const Eigen::Vector3d& p_map, FactSink& facts);
/// minX … maxZ [m, map].
void addBounds(rdf::TermId subject, const Eigen::Vector3d& min, const Eigen::Vector3d& max, FactSink& facts);

}  // namespace cluxel::mapping
