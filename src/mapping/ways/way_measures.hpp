// SPDX-License-Identifier: Apache-2.0
// Measures along and across the lines of ways and kerbs.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapping/ways/line_graph.hpp"
#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

/// An end of a way, and how far around it the ground is not the way's alone [m].
struct WayEnd {
  Eigen::Vector2d place;
  double reach_m = 0;
};

/// A way of the cells in `chain` without its places in the graph. `across`: by cell.
Way measuredWay(const LineGraph& graph, std::span<const AcrossWay> across, const std::vector<std::uint32_t>& chain,
                std::span<const WayEnd> ends);

/// Absent when it is shorter than kLeastKerb_m. `step_m`: by cell; 0 where there is none.
std::optional<Kerb> measuredKerb(const LineGraph& graph, std::span<const float> step_m,
                                 const std::vector<std::uint32_t>& chain);

}  // namespace cluxel::mapping
