// SPDX-License-Identifier: Apache-2.0
// A campus under construction: its plan and occupied ground; adds objects and surfaces.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "simulation/makers/mesh_shapes.hpp"
#include "simulation/site/campus.hpp"
#include "simulation/site/campus_random.hpp"
#include "simulation/site/site_plan.hpp"

namespace cluxel::simulation {

/// Object classes by their number in truthClassNames().
enum class ObjectClass : int {
  Ground,
  Building,
  Tree,
  Bush,
  StreetLamp,
  StreetSign,
  UtilityPole,
  Vehicle,
  SmallObject
};

/// Response of a surface to the laser.
struct SurfaceLook {
  float reflectivity = 0.5F;
  float transparency = 0;
};

/// A surface under construction; it becomes a CampusMesh when it is not empty.
CampusMesh surfaceOf(SurfaceLabel label, std::int32_t instance, const SurfaceLook& look);

class CampusSite {
 public:
  CampusSite(const CampusParams& params, const CampusFrame& frame);

  const SitePlan& plan() const { return plan_; }
  const Campus& campus() const { return campus_; }
  CampusRandom stream(RandomUse use, std::uint64_t number) const { return streamOf(campus_.params.seed, use, number); }
  /// The height of the ground at a place, kerbs included [m, map].
  Eigen::Vector3d onGround(const Eigen::Vector2d& place) const;

  /// Reserves a disc of ground. Returns false when it is occupied or would block the robot's route.
  bool claim(const Eigen::Vector2d& center, double radius);
  /// Reserves a whole strip likewise, or nothing.
  bool claimStrip(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double half_width);
  /// Reserves an axis-parallel rectangle without a check; buildings are laid out first.
  void reserve(const Eigen::AlignedBox2d& rectangle);
  /// Distance to the nearest reserved rectangle, 0 inside.
  double distanceToBuildings(const Eigen::Vector2d& place) const;
  /// True when a crown of this radius would touch an existing crown.
  bool touchesCrown(const Eigen::Vector2d& center, double radius) const;

  /// Adds an object and returns its number, which is the instance id of its surfaces.
  std::int32_t addObject(ObjectClass object_class, std::string kind, const Eigen::Vector3d& position, double reach_m);
  void addTrait(std::int32_t instance, std::string trait);
  void addSurface(CampusMesh surface);
  void addStop(const Eigen::Isometry3d& T_map_sensor) { campus_.stops.push_back(T_map_sensor); }

  /// The campus, rotated by the frame's heading, so that its directions are not those of the map's axes.
  Campus finish() &&;

 private:
  struct Disc {
    Eigen::Vector2d center;
    double radius;
  };
  bool isFree(const Disc& disc) const;

  Campus campus_;
  double heading_rad_;
  SitePlan plan_;
  std::vector<Disc> taken_;
  std::vector<Eigen::AlignedBox2d> reserved_;
};

}  // namespace cluxel::simulation
