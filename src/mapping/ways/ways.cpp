// SPDX-License-Identifier: Apache-2.0
// Lines and parts of regions of neighbouring tiles are joined, and lines become ways.
#include "mapping/ways/ways.hpp"

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.hpp"
#include "mapping/ways/line_graph.hpp"
#include "mapping/ways/way_measures.hpp"
#include "mapping/ways/way_network.hpp"
#include "mapping/ways/way_stage.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;

/// One of many arrays of tiles, each after the one before.
template <typename Value>
std::vector<Value> joined(std::span<const WayTile> tiles, std::vector<Value> WayTile::*column) {
  std::vector<Value> all;
  for (const WayTile& tile : tiles) all.insert(all.end(), (tile.*column).begin(), (tile.*column).end());
  return all;
}

/// The number of each tile's first part.
std::vector<std::uint32_t> firstParts(std::span<const WayTile> tiles) {
  std::vector<std::uint32_t> first{0};
  for (const WayTile& tile : tiles) first.push_back(first.back() + static_cast<std::uint32_t>(tile.parts.size()));
  return first;
}

/// Sets of parts that belong together.
DisjointSets linkedParts(const TileCells& cells, std::span<const WayTile> tiles,
                         const std::vector<std::uint32_t>& first) {
  DisjointSets sets(first.back());
  for (std::uint32_t slot = 0; slot < tiles.size(); ++slot)
    for (const RegionLink& link : tiles[slot].links) {
      const std::uint32_t near = cells.ringTile(slot, link.ring);
      if (near != kNoCell && link.other < tiles[near].parts.size())
        sets.join(first[slot] + link.own, first[near] + link.other);
    }
  return sets;
}

/// A part as a region of its own: its area is exact, so that sums do not depend on the order.
Region regionOf(const TileKey& tile, const RegionPart& part) {
  const auto corner = [&](int x, int y) {
    return centreOf(placeOf(tile, static_cast<std::uint32_t>(y * kCellsPerTile + x)));
  };
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * kWayCell_m);
  return {corner(part.min_x, part.min_y) - half, corner(part.max_x, part.max_y) + half,
          centreOf(placeOf(tile, part.first)), part.cells * kWayCell_m * kWayCell_m};
}

/// Fills the regions; returns the number of each part's region.
std::vector<std::size_t> addRegions(const TileCells& cells, std::span<const WayTile> tiles,
                                    const std::vector<std::uint32_t>& first, WayGraph& graph) {
  const std::vector<std::uint32_t> set_of = linkedParts(cells, tiles, first).numbers();
  std::vector<Region> sets;
  std::size_t number = 0;
  for (const WayTile& tile : tiles)
    for (const RegionPart& part : tile.parts) {
      const Region region = regionOf(tile.key, part);
      if (const std::uint32_t set = set_of[number++]; set == sets.size()) {
        sets.push_back(region);
      } else {
        sets[set].min = sets[set].min.cwiseMin(region.min), sets[set].max = sets[set].max.cwiseMax(region.max);
        sets[set].area_m2 += region.area_m2;
      }
    }
  std::vector<std::size_t> region_of_set(sets.size(), kNoPlace), region_of;
  for (std::size_t set = 0; set < sets.size(); ++set) {
    if (sets[set].area_m2 < kLeastRegion_m2) continue;
    region_of_set[set] = graph.regions.size();
    graph.regions.push_back(sets[set]);
  }
  for (const std::uint32_t set : set_of) region_of.push_back(region_of_set[set]);
  return region_of;
}

/// The cells of a line with those of its nodes.
std::vector<std::uint32_t> chainOf(const SkeletonNetwork& network, const SkeletonLine& line) {
  std::vector<std::uint32_t> chain{network.nodes[line.from]};
  chain.insert(chain.end(), line.cells.begin(), line.cells.end());
  chain.push_back(network.nodes[line.to]);
  return chain;
}

void addKerbs(const TileCells& cells, std::span<const WayTile> tiles, WayGraph& graph) {
  const LineGraph lines = lineGraphOf(cells, tiles, &WayTile::kerbs);
  const std::vector<float> step_m = joined(tiles, &WayTile::step_m);
  const SkeletonNetwork network = networkOf(lines);
  for (const SkeletonLine& line : network.lines)
    if (auto kerb = measuredKerb(lines, step_m, chainOf(network, line))) graph.kerbs.push_back(*std::move(kerb));
}

/// Nodes where three or more lines end become junctions; returns the number of each node's junction.
std::vector<std::size_t> addJunctions(const LineGraph& lines, const SkeletonNetwork& network, WayGraph& graph) {
  std::vector<std::size_t> junction_of(network.nodes.size(), kNoPlace);
  for (std::size_t node = 0; node < network.nodes.size(); ++node) {
    if (network.line_ends[node] < 3) continue;
    const Eigen::Vector2d centre = centreOf(lines.place[network.nodes[node]]);
    junction_of[node] = graph.junctions.size();
    graph.junctions.push_back({{centre.x(), centre.y(), lines.height[network.nodes[node]]}, network.line_ends[node]});
  }
  return junction_of;
}

/// `region_of`: of each cell.
void addWays(const LineGraph& lines, std::span<const AcrossWay> across, const std::vector<std::size_t>& region_of,
             WayGraph& graph) {
  const SkeletonNetwork network = networkOf(lines);
  const std::vector<std::size_t> junction_of = addJunctions(lines, network, graph);
  for (const SkeletonLine& line : network.lines) {
    const std::vector<std::uint32_t> chain = chainOf(network, line);
    std::vector<WayEnd> ends;
    std::vector<std::size_t> junctions;
    for (const std::uint32_t node : {line.from, line.to}) {
      const std::uint32_t cell = network.nodes[node];
      ends.push_back(
          {centreOf(lines.place[cell]), kWayCell_m * std::sqrt(static_cast<double>(lines.edge_distance2[cell]))});
      if (junction_of[node] != kNoPlace) junctions.push_back(junction_of[node]);
    }
    Way way = measuredWay(lines, across, chain, ends);
    if (junctions.empty() && way.length_m < kLeastWay_m) continue;
    std::sort(junctions.begin(), junctions.end());
    junctions.erase(std::unique(junctions.begin(), junctions.end()), junctions.end());
    way.junctions = std::move(junctions);
    way.region = region_of[chain[chain.size() / 2]];
    graph.ways.push_back(std::move(way));
  }
}

/// From the frame of the grid to that of the map.
void move(WayGraph& graph, const Eigen::Vector3d& by) {
  if (by.isZero(0)) return;
  for (Way& way : graph.ways)
    for (Eigen::Vector3d& point : way.line) point += by;
  for (Kerb& kerb : graph.kerbs)
    for (Eigen::Vector3d& point : kerb.line) point += by;
  for (Junction& junction : graph.junctions) junction.place += by;
  for (Region& region : graph.regions)
    for (Eigen::Vector2d* place : {&region.min, &region.max, &region.first_centre}) *place += by.head<2>();
}

}  // namespace

WayGraph mergedWays(std::span<const WayTile> tiles, const perception::TileGrid& grid) {
  std::vector<TileKey> keys;
  for (const WayTile& tile : tiles) keys.push_back(tile.key);
  const TileCells cells(std::move(keys));
  WayGraph graph;
  addKerbs(cells, tiles, graph);
  const std::vector<std::uint32_t> first = firstParts(tiles);
  const std::vector<std::size_t> region_of_part = addRegions(cells, tiles, first, graph);
  std::vector<std::size_t> region_of;
  for (std::size_t slot = 0; slot < tiles.size(); ++slot)
    for (const std::uint16_t part : tiles[slot].region)
      region_of.push_back(part == kNoRegion ? kNoPlace : region_of_part[first[slot] + part]);
  addWays(lineGraphOf(cells, tiles, &WayTile::middle), joined(tiles, &WayTile::across), region_of, graph);
  move(graph, grid.corner());
  return graph;
}

WayGraph waysOf(const perception::TileSet& tiles, const EvenTileSource& tileAt, const perception::TileGrid& grid) {
  const auto surfaces = surfaceTilesOf(tiles, tiles, tileAt);
  const auto found = wayTilesOf(tiles, tiles, tileAt, [&](const TileKey& key) { return surfaces.at(key); });
  std::vector<WayTile> all;
  for (const auto& [key, tile] : found) all.push_back(tile);
  return mergedWays(all, grid);
}

}  // namespace cluxel::mapping
