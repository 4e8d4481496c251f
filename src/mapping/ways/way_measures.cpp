// SPDX-License-Identifier: Apache-2.0
// Widths are measured where a way is not near its ends.
#include "mapping/ways/way_measures.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/ways/cell_line.hpp"

namespace cluxel::mapping {

namespace {

/// The march to an edge ends up to one step behind it.
double sideOf(std::uint8_t to_edge) {
  return std::max(0.0, (to_edge - 0.5) * kMarchStep_m);
}

/// Rise over run, over 2 m along the line.
double steepestOf(const std::vector<Eigen::Vector3d>& middle) {
  constexpr double run_m = 2;
  double steepest = 0;
  for (std::size_t i = 0, j = 0; j < middle.size(); ++j)
    while (i < j && (middle[j] - middle[i]).head<2>().norm() >= run_m) {
      const Eigen::Vector3d way = middle[j] - middle[i++];
      steepest = std::max(steepest, std::abs(way.z()) / way.head<2>().norm());
    }
  return steepest;
}

/// The cells of a chain that do not lie within the reach of its ends, or that in its middle.
std::vector<std::uint32_t> measuredCells(const LineGraph& graph, const std::vector<std::uint32_t>& chain,
                                         std::span<const WayEnd> ends) {
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t cell : chain) {
    const Eigen::Vector2d centre = centreOf(graph.place[cell]);
    if (std::none_of(ends.begin(), ends.end(),
                     [&](const WayEnd& end) { return (centre - end.place).norm() < end.reach_m; }))
      chosen.push_back(cell);
  }
  if (chosen.empty()) chosen.push_back(chain[chain.size() / 2]);
  return chosen;
}

}  // namespace

Way measuredWay(const LineGraph& graph, std::span<const AcrossWay> across, const std::vector<std::uint32_t>& chain,
                std::span<const WayEnd> ends) {
  const std::vector<Eigen::Vector3d> middle = smoothedLine(graph, chain);
  Way way;
  way.line = simplifiedLine(middle);
  way.length_m = lengthOf(way.line);
  way.steepest = steepestOf(middle);
  std::vector<double> widths;
  std::size_t lower = 0, higher = 0;
  const std::vector<std::uint32_t> chosen = measuredCells(graph, chain, ends);
  for (const std::uint32_t cell : chosen) {
    widths.push_back(sideOf(across[cell].left) + sideOf(across[cell].right));
    if (across[cell].is_lower) ++lower;
    if (across[cell].is_higher) ++higher;
  }
  std::sort(widths.begin(), widths.end());
  way.median_width_m = widths[widths.size() / 2];
  way.least_width_m = widths.front();
  way.lower_beside = static_cast<double>(lower) / static_cast<double>(chosen.size());
  way.higher_beside = static_cast<double>(higher) / static_cast<double>(chosen.size());
  return way;
}

std::optional<Kerb> measuredKerb(const LineGraph& graph, std::span<const float> step_m,
                                 const std::vector<std::uint32_t>& chain) {
  Kerb kerb;
  kerb.line = simplifiedLine(smoothedLine(graph, chain));
  kerb.length_m = lengthOf(kerb.line);
  if (kerb.length_m < kLeastKerb_m) return std::nullopt;
  std::vector<double> steps;
  for (const std::uint32_t cell : chain)
    if (step_m[cell] > 0) steps.push_back(step_m[cell]);
  if (steps.empty()) return std::nullopt;
  const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), median, steps.end());
  kerb.rise_m = *median;
  return kerb;
}

}  // namespace cluxel::mapping
