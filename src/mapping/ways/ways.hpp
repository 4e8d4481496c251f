// SPDX-License-Identifier: Apache-2.0
// The topological graph of a map's ground: ways with width and slope, junctions, and regions that can be walked.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "mapping/ways/even_ground.hpp"
#include "mapping/ways/way_tile.hpp"

namespace cluxel::mapping {

inline constexpr std::size_t kNoPlace = static_cast<std::size_t>(-1);

/// The middle line of even ground between two junctions or ends.
struct Way {
  std::vector<Eigen::Vector3d> line;  ///< [m, map]
  double length_m = 0;
  double median_width_m = 0, least_width_m = 0;  ///< away from its junctions, across the line
  double steepest = 0;                           ///< rise over run, over 2 m along the line
  double lower_beside = 0, higher_beside = 0;    ///< share of its length with a kerb down or up on a side
  std::size_t region = kNoPlace;                 ///< number in WayGraph::regions
  std::vector<std::size_t> junctions;            ///< at its ends; numbers in WayGraph::junctions, ascending
};

struct Junction {
  Eigen::Vector3d place;  ///< [m, map]
  std::uint32_t ways = 0;
};

/// Measured ground without things that one can cross without a step.
struct Region {
  Eigen::Vector2d min, max;      ///< [m, map]
  Eigen::Vector2d first_centre;  ///< of one of its cells, which names it [m, map]
  double area_m2 = 0;
};

/// A line along which the ground beside a way rises or falls at once.
struct Kerb {
  std::vector<Eigen::Vector3d> line;  ///< [m, map]
  double length_m = 0;
  double rise_m = 0;  ///< median of its step, positive
};

/// Each list is in an order that does not depend on other tiles.
struct WayGraph {
  std::vector<Way> ways;
  std::vector<Junction> junctions;
  std::vector<Region> regions;
  std::vector<Kerb> kerbs;
};

inline constexpr double kLeastRegion_m2 = 20;
inline constexpr double kLeastWay_m = 3;     ///< shorter lines without a junction are no ways
inline constexpr double kLeastKerb_m = 2;    ///< shorter steps are no kerbs
inline constexpr double kKerbSeen_m = 0.08;  ///< beside a way: the edge of a lawn is lower
inline constexpr double kKerbHigh_m = 0.25;  ///< what is higher is no kerb

/// The ways of a map from what its tiles contribute, of all tiles in ascending order. Cost: some 10 microseconds a tile
/// with ways. `grid`: in which the tiles lie.
WayGraph mergedWays(std::span<const WayTile> tiles, const perception::TileGrid& grid);

/// The same from even ground. Cost: about 1 ms a tile.
WayGraph waysOf(const perception::TileSet& tiles, const EvenTileSource& tileAt, const perception::TileGrid& grid);

}  // namespace cluxel::mapping
