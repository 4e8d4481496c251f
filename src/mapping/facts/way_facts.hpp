// SPDX-License-Identifier: Apache-2.0
// Facts about ways, junctions and regions.
#pragma once

#include "mapping/facts/fact_sink.hpp"
#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

/// Each resource is named by a hash of where it lies.
void addWayFacts(const WayGraph& graph, FactSink& facts);

}  // namespace cluxel::mapping
