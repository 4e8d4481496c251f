// SPDX-License-Identifier: Apache-2.0
// Refuses numbers of walks by name.
#include "tasks/ways/way_limits.hpp"

#include <algorithm>
#include <cstdio>

#include "cluxel/error.hpp"

namespace cluxel::tasks {

namespace {

std::string shortText(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

/// "0.125, 0.25, 0.5 or 1"
std::string cellsText() {
  std::string text;
  for (std::size_t i = 0; i < kCells_m.size(); ++i)
    text += (i == 0 ? "" : i + 1 < kCells_m.size() ? ", " : " or ") + shortText(kCells_m[i]);
  return text;
}

}  // namespace

void requireWithin(const Limits& limits, double value, const std::string& name) {
  if (value >= limits.min && value <= limits.max) return;
  throw Error(ErrorKind::InvalidArgument, name + ": write a number from " + shortText(limits.min) + " to " +
                                              shortText(limits.max) + ", not " + shortText(value));
}

void requireValid(const WayRequest& request) {
  requireWithin(kWidth_m, request.params.width_m, "free width [m]");
  requireWithin(kMaxSlope, request.params.max_slope, "largest slope");
  requireWithin(kMaxStep_m, request.params.max_step_m, "largest step [m]");
  requireWithin(kClearance_m, request.terrain.highest_m, "clearance [m]");
  if (std::find(kCells_m.begin(), kCells_m.end(), request.terrain.cell_m) == kCells_m.end())
    throw Error(ErrorKind::InvalidArgument,
                "edge of a cell [m]: write " + cellsText() + ", not " + shortText(request.terrain.cell_m));
}

void requireValid(const SearchRequest& request) {
  requireValid(request.ways);
  requireWithin(kView_m, request.search.view_m, "view [m]");
  requireWithin(kDetection, request.search.detection, "detection");
  requireWithin(kTourStops, static_cast<double>(request.tour.max_stops), "largest number of stops");
  requireWithin(kBudget_m, request.tour.budget_m, "budget of the walk [m]");
}

}  // namespace cluxel::tasks
