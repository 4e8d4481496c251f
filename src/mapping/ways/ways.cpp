// SPDX-License-Identifier: Apache-2.0
// Measures along and across the lines of the skeleton.
#include "mapping/ways/ways.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/ways/cell_line.hpp"
#include "mapping/ways/kerbs.hpp"
#include "mapping/ways/skeleton.hpp"
#include "mapping/ways/way_network.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::uint16_t kEndDistance2 = 6;  // 0.6 m from the edge
constexpr double kMarchStep_m = 0.125, kFarthestSide_m = 12;

/// What one side of a way is like, seen from a cell of its middle line.
struct SideView {
  double to_edge_m = 0;
  std::optional<double> rise_m;  ///< of the ground beyond the edge; absent where it was not measured
};

class WayMeasure {
 public:
  WayMeasure(const GroundCells& ground, std::vector<std::uint32_t> cells) : ground_(ground), cells_(std::move(cells)) {
    middle_ = smoothedLine(ground_, cells_);
  }

  Way measured(const std::vector<Eigen::Vector2d>& junctions, const std::vector<double>& reach_m) const {
    Way way;
    way.line = simplifiedLine(middle_);
    way.length_m = lengthOf(way.line);
    const auto is_free = [&](std::size_t i) {
      for (std::size_t j = 0; j < junctions.size(); ++j)
        if ((ground_.cells.centreOf(cells_[i]) - junctions[j]).norm() < reach_m[j]) return false;
      return true;
    };
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (is_free(i)) chosen.push_back(i);
    if (chosen.empty()) chosen.push_back(cells_.size() / 2);
    std::vector<double> widths;
    std::size_t lower = 0, higher = 0;
    for (const std::size_t i : chosen) {
      const SideView left = side(i, 1), right = side(i, -1);
      widths.push_back(left.to_edge_m + right.to_edge_m);
      const auto is_kerb = [](const SideView& view, double sign) {
        return view.rise_m && *view.rise_m * sign >= kKerbSeen_m && *view.rise_m * sign <= kKerbHigh_m;
      };
      if (is_kerb(left, -1) || is_kerb(right, -1)) ++lower;
      if (is_kerb(left, 1) || is_kerb(right, 1)) ++higher;
    }
    std::sort(widths.begin(), widths.end());
    way.median_width_m = widths[widths.size() / 2];
    way.least_width_m = widths.front();
    way.lower_beside = static_cast<double>(lower) / static_cast<double>(chosen.size());
    way.higher_beside = static_cast<double>(higher) / static_cast<double>(chosen.size());
    way.steepest = steepest();
    return way;
  }

 private:
  SideView side(std::size_t i, int sign) const {
    const std::size_t before = i - std::min(i, kSmoothedCells);
    const std::size_t after = std::min(i + kSmoothedCells, middle_.size() - 1);
    Eigen::Vector2d along = (middle_[after] - middle_[before]).head<2>();
    if (along.norm() == 0) along = {1, 0};
    const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()) / along.norm() * sign;
    const Eigen::Vector2d centre = ground_.cells.centreOf(cells_[i]);
    const Eigen::Vector2d start = middle_[i].head<2>() - centre;  // from the cell's centre
    const auto cell_at = [&](double distance) {
      const Eigen::Vector2d offset = (start + across * distance) / kWayCell_m;
      const double dx = std::floor(offset.x() + 0.5), dy = std::floor(offset.y() + 0.5);
      return ground_.cells.step(cells_[i], static_cast<int>(dx), static_cast<int>(dy));
    };
    SideView view;
    std::uint32_t last = cells_[i];
    while (view.to_edge_m < kFarthestSide_m) {
      const std::uint32_t cell = cell_at(view.to_edge_m);
      if (cell == kNoCell || ground_.even[cell] == 0) break;
      last = cell;
      view.to_edge_m += kMarchStep_m;
    }
    constexpr double beyond_m = 0.5;
    const std::uint32_t beyond = cell_at(view.to_edge_m + beyond_m);
    if (beyond != kNoCell && ground_.measured[beyond] != 0) view.rise_m = ground_.height[beyond] - ground_.height[last];
    view.to_edge_m = std::max(0.0, view.to_edge_m - 0.5 * kMarchStep_m);
    return view;
  }

  double steepest() const {
    constexpr double run_m = 2;
    double steepest = 0;
    for (std::size_t i = 0, j = 0; j < middle_.size(); ++j)
      while (i < j && (middle_[j] - middle_[i]).head<2>().norm() >= run_m) {
        const Eigen::Vector3d way = middle_[j] - middle_[i++];
        steepest = std::max(steepest, std::abs(way.z()) / way.head<2>().norm());
      }
    return steepest;
  }

  const GroundCells& ground_;
  std::vector<std::uint32_t> cells_;
  std::vector<Eigen::Vector3d> middle_;
};

/// Fills the regions; returns the number of each cell's region.
std::vector<std::uint32_t> addRegions(const GroundCells& ground, WayGraph& graph) {
  const TileCells& cells = ground.cells;
  std::vector<std::uint32_t> region_of(cells.size(), kNoCell);
  std::vector<std::uint8_t> is_open(cells.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell)
    is_open[cell] = (ground.measured[cell] != 0 || ground.even[cell] != 0) && ground.thing[cell] == 0 ? 1 : 0;
  std::vector<std::uint32_t> part;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (is_open[start] == 0) continue;
    part.assign(1, start);
    is_open[start] = 0;
    Region region{cells.centreOf(start), cells.centreOf(start), cells.centreOf(start), 0};
    for (std::size_t at = 0; at < part.size(); ++at) {
      const Eigen::Vector2d centre = cells.centreOf(part[at]);
      region.min = region.min.cwiseMin(centre), region.max = region.max.cwiseMax(centre);
      for (const auto& [dx, dy] : kAroundCell) {
        const std::uint32_t near = cells.step(part[at], dx, dy);
        if (near == kNoCell || is_open[near] == 0) continue;
        if (!(std::abs(ground.height[near] - ground.height[part[at]]) <= kKerbLow_m)) continue;
        is_open[near] = 0;
        part.push_back(near);
      }
    }
    region.area_m2 = static_cast<double>(part.size()) * kWayCell_m * kWayCell_m;
    if (region.area_m2 < kLeastRegion_m2) continue;
    region.min.array() -= 0.5 * kWayCell_m, region.max.array() += 0.5 * kWayCell_m;
    for (const std::uint32_t cell : part) region_of[cell] = static_cast<std::uint32_t>(graph.regions.size());
    graph.regions.push_back(region);
  }
  return region_of;
}

}  // namespace

WayGraph waysOf(std::vector<perception::TileKey> keys, const EvenTileSource& tileAt) {
  WayGraph graph;
  const GroundCells ground = groundCellsOf(std::move(keys), tileAt);
  const TileCells& cells = ground.cells;
  graph.kerbs = kerbsOf(ground);
  const std::vector<std::uint32_t> region_of = addRegions(ground, graph);
  const auto distance2 = squaredEdgeDistances(cells, ground.even);
  const SkeletonNetwork network = networkOf(cells, skeletonOf(cells, distance2, kEndDistance2), distance2);
  std::vector<std::size_t> junction_of(network.nodes.size(), kNoPlace);
  for (std::size_t node = 0; node < network.nodes.size(); ++node) {
    if (network.line_ends[node] < 3) continue;
    const Eigen::Vector2d centre = cells.centreOf(network.nodes[node]);
    junction_of[node] = graph.junctions.size();
    graph.junctions.push_back({{centre.x(), centre.y(), ground.height[network.nodes[node]]}, network.line_ends[node]});
  }
  for (const SkeletonLine& line : network.lines) {
    std::vector<std::uint32_t> chain{network.nodes[line.from]};
    chain.insert(chain.end(), line.cells.begin(), line.cells.end());
    chain.push_back(network.nodes[line.to]);
    std::vector<Eigen::Vector2d> places;
    std::vector<double> reach_m;
    std::vector<std::size_t> junctions;
    for (const std::uint32_t node : {line.from, line.to}) {
      places.push_back(cells.centreOf(network.nodes[node]));
      reach_m.push_back(kWayCell_m * std::sqrt(static_cast<double>(distance2[network.nodes[node]])));
      if (junction_of[node] != kNoPlace) junctions.push_back(junction_of[node]);
    }
    Way way = WayMeasure(ground, chain).measured(places, reach_m);
    if (junctions.empty() && way.length_m < kLeastWay_m) continue;
    std::sort(junctions.begin(), junctions.end());
    junctions.erase(std::unique(junctions.begin(), junctions.end()), junctions.end());
    way.junctions = std::move(junctions);
    if (const std::uint32_t region = region_of[chain[chain.size() / 2]]; region != kNoCell) way.region = region;
    graph.ways.push_back(std::move(way));
  }
  return graph;
}

}  // namespace cluxel::mapping
