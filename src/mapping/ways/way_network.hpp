// SPDX-License-Identifier: Apache-2.0
// A skeleton as lines between nodes, without short spurs.
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/ways/line_graph.hpp"

namespace cluxel::mapping {

/// A line of neighbouring cells between two nodes; of a closed line they are one.
struct SkeletonLine {
  std::uint32_t from = 0, to = 0;    ///< numbers of nodes
  std::vector<std::uint32_t> cells;  ///< without those of the nodes
  double length_m = 0;
};

struct SkeletonNetwork {
  std::vector<std::uint32_t> nodes;  ///< the cell of each
  std::vector<SkeletonLine> lines;
  std::vector<std::uint32_t> line_ends;  ///< per node, how many ends of lines it has
};

/// Leaves out dead ends that are shorter than the way is wide at their start, and merges junctions of which each lies
/// within the other's width.
SkeletonNetwork networkOf(const LineGraph& graph);

}  // namespace cluxel::mapping
