// SPDX-License-Identifier: Apache-2.0
// A procedural campus: labelled triangle meshes, the objects that they form, and the stops of the robot.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "simulation/laser/surface_label.hpp"
#include "simulation/site/campus_params.hpp"

namespace cluxel::simulation {

struct Terrain {
  struct Wave {
    Eigen::Vector2d wave_number = Eigen::Vector2d::Zero();  ///< [rad/m]
    double amplitude_m = 0, phase_rad = 0;
  };
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< rise per metre along x and y
  std::array<Wave, 3> waves;

  /// Height of the terrain [m, map], without kerbs and the roughness of grass.
  double heightAt(double x, double y) const {
    double height = slope.x() * x + slope.y() * y;
    for (const Wave& wave : waves)
      height += wave.amplitude_m * std::sin(wave.wave_number.x() * x + wave.wave_number.y() * y + wave.phase_rad);
    return height;
  }
  /// The maximum slope (rise per metre).
  double steepest() const {
    double sum = slope.norm();
    for (const Wave& wave : waves) sum += wave.amplitude_m * wave.wave_number.norm();
    return sum;
  }
};

/// One surface of one object, in the map frame [m].
struct CampusMesh {
  SurfaceLabel label = SurfaceLabel::Lawn;
  std::int32_t instance = -1;  ///< number in Campus::objects, or -1
  float reflectivity = 0.5F;   ///< share of the light that a diffuse surface sends back, in [0, 1]
  float transparency = 0;      ///< share of rays that do not return from it, in [0, 1]
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One object of the campus. Its index in Campus::objects is its instance id in the truth of all scans; 0 is the
/// ground.
struct CampusObject {
  int class_number = -1;                               ///< number in truthClassNames()
  std::string kind;                                    ///< for people: "spruce", "lamp with arm"
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< where it stands on the ground [m, map]
  Eigen::AlignedBox3d box;                             ///< bounds of its surfaces [m, map]
  double reach_m = 0;                                  ///< radius of a tree's crown, else of its footprint
  std::vector<std::string> traits;  ///< "under a crown", "leaves on top", "two plates", "crown touches 17"
};

struct Campus {
  CampusParams params;
  double heading_rad = 0;  ///< of the street, from the map's x; the whole plan is turned by it
  Terrain terrain;
  std::vector<CampusObject> objects;
  std::vector<CampusMesh> meshes;
  std::vector<Eigen::Isometry3d> stops;  ///< T_map_sensor, about 1.2 m above the ground
};

/// What a campus does not choose itself when it is part of something larger.
struct CampusFrame {
  Terrain terrain;  ///< as it lies before the plan is turned
  double heading_rad = 0;
};

/// The frame that follows from a seed.
CampusFrame campusFrameOf(std::uint64_t seed);

/// The campus that follows from `params`, on one thread. Cost: well below a second per hectare. Throws as
/// check(CampusParams) does.
Campus buildCampus(const CampusParams& params);
/// The same in another frame: what stands on it follows from the seed of `params`.
Campus buildCampus(const CampusParams& params, const CampusFrame& frame);

/// Where a campus lies as a district of a city.
struct DistrictPlace {
  std::uint64_t city_seed = 0;
  std::size_t number = 0, column = 0, row = 0;           ///< numbers run along rows, from 0
  Eigen::Vector3d origin_map = Eigen::Vector3d::Zero();  ///< of the district's own frame [m, map]
  std::int32_t first_instance = 0;                       ///< its objects are numbered from here
};

/// The text of campus.json: parameters, surfaces, and objects with class, kind, box, parts and traits.
std::string describeCampus(const Campus& campus);
/// The same for a district, with its place, in the frame of the city's map.
std::string describeDistrict(const Campus& campus, const DistrictPlace& place);

}  // namespace cluxel::simulation
