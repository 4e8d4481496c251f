// SPDX-License-Identifier: Apache-2.0
// One facade: a wall with recessed windows, string courses and a door with steps.
#pragma once

#include <Eigen/Core>

#include "simulation/site/campus_site.hpp"

namespace cluxel::simulation {

/// The surfaces of one building.
struct BuildingSurfaces {
  BuildingSurfaces(std::int32_t instance, float wall_reflectivity);
  void addTo(CampusSite& site);

  CampusMesh facade, window, door, ledge, flat_roof, gabled_roof, column, stairs;
};

struct FacadeStyle {
  int floors = 2;
  double floor_height_m = 3.2, bay_m = 3;
  double window_width_m = 1.2, window_height_m = 1.5, sill_m = 0.95;
  double recess_m = 0.15;
  double course_depth_m = 0.1;  ///< how far the ledge between floors stands out; 0: none
};

struct FacadePlace {
  Eigen::Vector3d origin;          ///< left lower corner at the level of the ground floor, seen from outside [m, map]
  Eigen::Vector3d along, outward;  ///< unit vectors
  double length_m = 10;
  bool door = false;
};

void addFacade(BuildingSurfaces& surfaces, const FacadeStyle& style, const FacadePlace& place);

}  // namespace cluxel::simulation
