// SPDX-License-Identifier: Apache-2.0
// Facts about ways, junctions, regions and kerbs.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/facts/fact_sink.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

struct ToldWays {
  std::vector<ToldWay> now;                             ///< all of a graph, ascending
  std::set<std::pair<WayKind, ContentHash>> exchanged;  ///< names of which facts were added, or are to be removed
};

/// Adds the facts of a graph, but for those of resources that `before` has with the same cause. Each resource is named
/// by a hash of where it lies.
ToldWays addWayFacts(const WayGraph& graph, const std::vector<ToldWay>& before, FactSink& facts);

std::string iriOfWay(WayKind kind, const ContentHash& name);
/// What the IRIs of all of a kind begin with.
std::string iriOfWays(WayKind kind);

}  // namespace cluxel::mapping
