// SPDX-License-Identifier: Apache-2.0
// Routes over a map's ground, other routes beside the best, what closes a way, and what is within reach.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rdf/ontology/ontology.hpp"
#include "tasks/ways/passable_grid.hpp"

namespace cluxel::tasks {

/// What a way must be like. Classes are written as for classNamed(); `without` also takes "Movable" and "Static".
struct WayRequest {
  WayParams params = {};
  TerrainParams terrain = {};
  std::vector<std::string> without;  ///< objects to leave out
  bool with_gone = false;            ///< objects that later scans saw through (clx:seenThrough) are there all the same
  std::string near;                  ///< the way should stay near things, places or ways of this class; empty: none
};

/// Per object: whether the request leaves it out. Throws as passableIn().
std::vector<bool> leftOut(const mapping::MapReader& map, const WayRequest& request);

/// The terrain of a request: what it leaves out is no ground. Throws as passableIn().
TerrainGrid terrainIn(const mapping::MapReader& map, const WayRequest& request);

/// Throws Error (NotFound) for a class that the map's ontology does not know, and where there is nothing to stay near.
PassableGrid passableIn(const mapping::MapReader& map, const WayRequest& request);
/// The same with the terrain of the request that is there already.
PassableGrid passableIn(const mapping::MapReader& map, const TerrainGrid& terrain, const WayRequest& request);

/// "X,Y" in metres of the map frame, or an object: its IRI, at least four digits of its hash, or "#17". Throws Error
/// (InvalidArgument, NotFound).
Eigen::Vector2d placeNamed(const mapping::MapReader& map, const std::string& text);

/// The open cell nearest to a place. Throws Error (NotFound) when there is none within 2 m.
std::uint32_t openCellNear(const PassableGrid& grid, const Eigen::Vector2d& p_map);

struct Route {
  std::vector<std::uint32_t> cells;
  double cost = 0;
  double length_m = 0;
  double climb_m = 0;         ///< sum of all that goes up
  double steepest = 0;        ///< rise over run
  double highest_step_m = 0;  ///< as PassableGrid::stepBetween()
  double narrowest_m = 0;     ///< free width at the narrowest place; infinite without things
};

/// A stretch of closed cells on the way that is cheapest where each closed cell, and each step, costs 100.
struct Barrier {
  enum class Kind : std::uint8_t { Unobserved, Obstacle, TooSteep, TooNarrow, Step };
  Kind kind = Kind::Obstacle;
  std::uint32_t thing = kUnnamedThing;           ///< of Obstacle and TooNarrow
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< where the stretch begins [m, map]
  double length_m = 0;
  double measured = 0;  ///< slope, free width [m] or height of the step [m]
};

struct RouteAnswer {
  std::vector<Route> routes;      ///< best first; empty: no way leads there
  std::vector<Barrier> barriers;  ///< without a route: what is in the way
};

/// At most `count` routes; a further one shares less than 70 % of its cells with the surroundings of those before.
/// Start and goal are moved to the nearest open cell within 2 m; Error (NotFound) when there is none.
RouteAnswer findRoutes(const PassableGrid& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       std::size_t count);

/// The cells within a walk of `reach_m`, with the length of the shortest walk; infinite beyond.
LargeArray<double> walkLengths(const PassableGrid& grid, const Eigen::Vector2d& from, double reach_m);

/// Objects within reach: the middle of a cell of theirs lies within a metre of that of a cell within the walk. By
/// length of the walk.
struct ReachedObject {
  std::uint32_t object = 0;
  double walk_m = 0;
};
std::vector<ReachedObject> objectsWithin(const TerrainGrid& terrain, const LargeArray<double>& walk_m,
                                         const std::vector<bool>& is_left_out);

}  // namespace cluxel::tasks
