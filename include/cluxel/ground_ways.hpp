// SPDX-License-Identifier: Apache-2.0
// Ways over the ground of a map for walkers and robots: routes, what closes them, and cost maps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cluxel/object.hpp"

namespace cluxel {

/// Where a way begins or ends: a position, or an object by its IRI, at least four leading digits of its hash, or its
/// number ("#17"). The text "X,Y" is a position, too.
using Place = std::variant<GroundPosition, std::string>;

/// What ground can be used. Numbers out of range are refused.
struct GroundOptions {
  double max_slope = 0.12;                ///< rise over run, 0 to 10
  double max_step_m = 0.06;               ///< height of a kerb that can be crossed, 0 to 2
  double clearance_m = 2;                 ///< what hangs higher above the ground is no obstacle, 0.3 to 20
  double cell_m = 0.25;                   ///< edge of a grid cell: 0.125, 0.25, 0.5 or 1
  std::vector<std::string> without = {};  ///< classes of objects to leave out, or "Movable" or "Static"
  bool with_gone = false;                 ///< objects that later scans saw through are there all the same
};

struct RouteOptions {
  GroundOptions ground = {};
  double width_m = 0.6;          ///< free width that is needed, 0 to 20
  std::string near = {};         ///< a class: the way should stay near such things; empty: none
  std::size_t alternatives = 1;  ///< largest number of routes, 1 to 9
};

struct Route {
  std::vector<GroundPosition> line;  ///< corners of the way, from start to goal
  double length_m = 0;
  double cost = 0;                    ///< a metre costs 1, more on slopes, beside things and far from `near`
  double climb_m = 0;                 ///< sum of all that goes up
  double steepest = 0;                ///< rise over run
  double highest_step_m = 0;          ///< of the kerbs that it crosses
  std::optional<double> narrowest_m;  ///< free width at the narrowest place; absent without things
};

/// Thing: it stands there. TooNarrow: the ground beside it is. Step: one that is too high.
enum class BarrierKind : std::uint8_t { Unobserved, Thing, TooSteep, TooNarrow, Step };

/// A stretch of closed ground on the way that crosses the least of it.
struct Barrier {
  BarrierKind kind = BarrierKind::Thing;
  std::string object;   ///< IRI of the object of Thing and TooNarrow; empty: none, or no object that the map knows
  GroundPosition at;    ///< where the stretch begins
  double length_m = 0;  ///< of the stretch
  /// Slope of TooSteep (rise over run), free width of TooNarrow [m], height of Step [m].
  std::optional<double> measured;
  std::string text;  ///< in English: "a step of 0.12 m at (3.1, 4.0), for 0.2 m"
};

struct Routes {
  std::vector<Route> routes;      ///< best first; empty: no way leads there
  std::vector<Barrier> barriers;  ///< without a route: what is in the way
};

/// What a cell of ground is. All but Free and Unobserved are closed. Step: beside a step that is too high.
enum class GroundKind : std::uint8_t { Free, Thing, Step, TooSteep, Unobserved };

/// The ground as square cells of the map frame, row by row from the corner with the smallest x and y: the cell of
/// column c and row r is cells[r * columns + c], and its centre is at (min_x + (c + 0.5) cell_m, min_y + (r + 0.5)
/// cell_m).
struct CostMap {
  double min_x = 0, min_y = 0;  ///< that corner [m, map]
  double cell_m = 0;
  std::size_t columns = 0, rows = 0;
  std::vector<GroundKind> cells;
};

}  // namespace cluxel
