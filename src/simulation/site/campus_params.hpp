// SPDX-License-Identifier: Apache-2.0
// The parameters of a generated campus, each with unit, range and help, declared once.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace cluxel::simulation {

/// The scanner at a stop: a panoramic scanner with equal angular steps, or a vehicle's scanner with 64 rings (-24.8 to
/// 2 degrees).
enum class LaserKind { PanTilt, Spinning };

/// The campus and its scans are a function of these parameters.
struct CampusParams {
  std::uint64_t seed = 1;
  double stops = 12;                 ///< scans along the route, one every 10 m
  double size_m = 100;               ///< edge of the square campus; the ground goes on for 15 m around it
  double points_per_stop = 175'000;  ///< returns per scan, kept within about 5 %
  double range_sigma_m = 0.012;      ///< standard deviation of the range noise
  double max_range_m = 60;
  double miss_probability = 0.005;       ///< share of rays lost at random
  double mixed_pixel_probability = 0.6;  ///< of a ray that is cut by a depth edge
  double beam_radius_rad = 0.003;        ///< half the divergence of the beam
  double stop_distance_m = 10;           ///< along the route
  double drift_m = 0;                    ///< error that the stated poses gain from scan to scan, mostly forwards
  double visits = 1;                     ///< drives along the route, a day after each other; things change in between
  double pose_error_m = 0;               ///< standard deviation of the errors of the stated poses on later visits
  double later_stops = 0;                ///< stops of each later visit, spread over the route; 0: as many as the first
  LaserKind laser = LaserKind::PanTilt;
};

/// The name, unit, range and help of a field of CampusParams.
struct CampusParamInfo {
  std::string_view name;  ///< as options write it: "points-per-stop"
  double CampusParams::*field;
  std::string_view unit;
  double min, max;
  std::string_view help;
};

/// One row per numeric parameter, except the seed, which has no range.
const std::array<CampusParamInfo, 13>& campusParamInfos();

/// The maximum number of stops on the route of a campus of this size.
std::size_t maxStops(double size_m, double stop_distance_m = CampusParams{}.stop_distance_m);

/// Throws Error (InvalidArgument) naming the parameter, its range, and for too many stops the size that has room for
/// them.
void check(const CampusParams& params);

}  // namespace cluxel::simulation
