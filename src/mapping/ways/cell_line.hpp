// SPDX-License-Identifier: Apache-2.0
// Chains of cells as lines.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/ways/line_graph.hpp"

namespace cluxel::mapping {

inline constexpr std::size_t kSmoothedCells = 4;  ///< on each side of a cell
inline constexpr double kLineTolerance_m = 0.15;  ///< of simplified lines

/// The centres of the cells on the ground, each the mean of those around it on the chain [m, map].
std::vector<Eigen::Vector3d> smoothedLine(const LineGraph& graph, const std::vector<std::uint32_t>& chain);

/// Some of the points of a line, from which no other is farther than kLineTolerance_m in plan view (Douglas and
/// Peucker).
std::vector<Eigen::Vector3d> simplifiedLine(const std::vector<Eigen::Vector3d>& line);

/// In plan view [m].
double lengthOf(const std::vector<Eigen::Vector3d>& line);

}  // namespace cluxel::mapping
