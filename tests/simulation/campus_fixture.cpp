// SPDX-License-Identifier: Apache-2.0
// Parameters of small campuses.
#include "simulation/campus_fixture.hpp"

#include "simulation/makers/mesh_shapes.hpp"

namespace cluxel::test {

using namespace scan;
using namespace simulation;

CampusParams smallCampus(std::uint64_t seed) {
  CampusParams params;
  params.seed = seed;
  params.stops = 4;
  params.size_m = 50;
  params.points_per_stop = 40'000;
  return params;
}

CampusParams withoutNoise(CampusParams params) {
  params.range_sigma_m = params.miss_probability = params.mixed_pixel_probability = params.beam_radius_rad = 0;
  return params;
}

Campus room(const CampusParams& params, double half_m) {
  Campus campus;
  campus.params = params;
  campus.objects.push_back(
      {.class_number = 1, .kind = "room", .position = {}, .box = {}, .reach_m = half_m, .traits = {}});
  CampusMesh walls;
  walls.label = SurfaceLabel::Facade;
  walls.instance = 0;
  addBox(walls, Eigen::Isometry3d::Identity(), Eigen::Vector3d::Constant(2 * half_m));
  campus.meshes.push_back(walls);
  campus.stops.push_back(Eigen::Isometry3d::Identity());
  return campus;
}

std::vector<SimulatedScan> scanAll(const Campus& campus) {
  const Laser laser(campus);
  std::vector<SimulatedScan> scans;
  for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) scans.push_back(laser.scanAt(stop));
  return scans;
}

}  // namespace cluxel::test
