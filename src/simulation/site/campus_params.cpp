// SPDX-License-Identifier: Apache-2.0
// The table of parameters and their check.
#include "simulation/site/campus_params.hpp"

#include <cmath>
#include <string>

#include "base/text/short_number.hpp"
#include "cluxel/error.hpp"
#include "simulation/site/site_plan.hpp"

namespace cluxel::simulation {

namespace {
constexpr double kMaxSize_m = 400;
}

const std::array<CampusParamInfo, 13>& campusParamInfos() {
  using P = CampusParams;
  static const std::array<CampusParamInfo, 13> infos{{
      {"stops", &P::stops, "1", 1, 1000, "scans along the route"},
      {"size", &P::size_m, "m", 45, kMaxSize_m, "edge of the square campus"},
      {"points-per-stop", &P::points_per_stop, "1", 1000, 2e6, "returns per scan"},
      {"range-sigma", &P::range_sigma_m, "m", 0, 0.2, "standard deviation of the range noise"},
      {"max-range", &P::max_range_m, "m", 5, 300, "farthest return"},
      {"miss-probability", &P::miss_probability, "1", 0, 0.5, "share of rays that are lost at random"},
      {"mixed-pixel-probability", &P::mixed_pixel_probability, "1", 0, 1,
       "share of rays on depth edges that mix both ranges"},
      {"beam-radius", &P::beam_radius_rad, "rad", 0, 0.02, "half the divergence of the beam"},
      {"stop-distance", &P::stop_distance_m, "m", 0.2, 50, "from stop to stop along the route"},
      {"drift", &P::drift_m, "m", 0, 1, "error that the stated poses gain from scan to scan"},
      {"visits", &P::visits, "1", 1, 9, "drives along the route, between which things change"},
      {"pose-error", &P::pose_error_m, "m", 0, 0.5, "deviation of the stated poses on later visits"},
      {"later-stops", &P::later_stops, "1", 0, 1000, "scans of each later visit, spread over the route; 0: all"},
  }};
  return infos;
}

namespace {

void checkRange(const CampusParams& params, const CampusParamInfo& info) {
  const double value = params.*info.field;
  if (value >= info.min && value <= info.max) return;
  const std::string unit = info.unit == "1" ? "" : " " + std::string(info.unit);
  throw Error(ErrorKind::InvalidArgument, "the campus cannot have " + std::string(info.name) + " = " +
                                              shortNumber(value) + unit + " (" + std::string(info.help) + "): choose " +
                                              shortNumber(info.min) + " to " + shortNumber(info.max) + unit);
}

/// What is said of later visits needs one.
void checkLaterVisits(const CampusParams& params) {
  if (params.visits > 1) return;
  const bool is_of_poses = params.pose_error_m != 0;
  if (!is_of_poses && params.later_stops == 0) return;
  throw Error(ErrorKind::InvalidArgument,
              std::string(is_of_poses ? "pose-error" : "later-stops") +
                  " concerns later visits, and there is one visit: choose visits = 2 or more, or leave " +
                  (is_of_poses ? "pose-error" : "later-stops") + " at 0");
}

}  // namespace

std::size_t maxStops(double size_m, double stop_distance_m) {
  return static_cast<std::size_t>(SitePlan(size_m).routeLength_m() / stop_distance_m);
}

void check(const CampusParams& params) {
  for (const CampusParamInfo& info : campusParamInfos()) checkRange(params, info);
  if (params.stops != std::floor(params.stops))
    throw Error(ErrorKind::InvalidArgument,
                "the campus cannot have " + shortNumber(params.stops) + " stops: give a whole number");
  if (params.visits != std::floor(params.visits))
    throw Error(ErrorKind::InvalidArgument,
                "the campus cannot have " + shortNumber(params.visits) + " visits: give a whole number");
  if (params.later_stops != std::floor(params.later_stops) || params.later_stops > params.stops)
    throw Error(ErrorKind::InvalidArgument, "later visits cannot have " + shortNumber(params.later_stops) +
                                                " stops: give a whole number of at most " + shortNumber(params.stops));
  checkLaterVisits(params);
  const auto stops = static_cast<std::size_t>(params.stops);
  if (stops <= maxStops(params.size_m, params.stop_distance_m)) return;
  double roomy_m = std::ceil(params.size_m);
  while (roomy_m <= kMaxSize_m && maxStops(roomy_m, params.stop_distance_m) < stops) roomy_m += 1;
  throw Error(ErrorKind::InvalidArgument,
              "a campus of " + shortNumber(params.size_m) + " m has a route of " +
                  std::to_string(maxStops(params.size_m, params.stop_distance_m)) + " stops, not " +
                  std::to_string(stops) + ": choose fewer stops" +
                  (roomy_m <= kMaxSize_m ? " or a size of " + shortNumber(roomy_m) + " m" : ", nearer to each other"));
}

}  // namespace cluxel::simulation
