// SPDX-License-Identifier: Apache-2.0
// Builds a campus from its parameters: ground, buildings, vegetation, other objects and the robot's stops.
#include "simulation/site/campus.hpp"

#include <algorithm>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector3d;
constexpr double kDegree = std::numbers::pi / 180;

void placeStops(CampusSite& site) {
  const CampusParams& params = site.campus().params;
  const double height_m = params.laser == LaserKind::Spinning ? 1.7 : 1.2;
  const double distance_m = params.stop_distance_m, unrest = std::min(1.0, distance_m / 10);
  const auto count = static_cast<std::size_t>(params.stops);
  for (std::size_t stop = 0; stop < count; ++stop) {
    CampusRandom random = site.stream(RandomUse::Stop, stop);
    const auto route = site.plan().routeAt(distance_m * static_cast<double>(stop));
    const Eigen::Vector2d place =
        route.position + unrest * Eigen::Vector2d{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
    T_map_sensor.translation() = site.onGround(place) + Vector3d{0, 0, height_m};
    const double yaw = route.heading_rad + unrest * 8 * kDegree * random.normal();
    const double pitch = kDegree * random.normal(), roll = kDegree * random.normal();
    T_map_sensor.linear() = (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
                             Eigen::AngleAxisd(roll, Vector3d::UnitX()))
                                .toRotationMatrix();
    site.addStop(T_map_sensor);
  }
}

void noteCrownsAbove(CampusSite& site) {
  const std::vector<CampusObject> objects = site.campus().objects;
  for (std::size_t low = 0; low < objects.size(); ++low) {
    const int class_number = objects[low].class_number;
    if (class_number != static_cast<int>(ObjectClass::StreetLamp) &&
        class_number != static_cast<int>(ObjectClass::StreetSign))
      continue;
    for (const CampusObject& tree : objects) {
      const double distance = (tree.position - objects[low].position).head<2>().norm();
      if (tree.class_number != static_cast<int>(ObjectClass::Tree) || distance > tree.reach_m) continue;
      site.addTrait(static_cast<std::int32_t>(low), "under a crown");
      break;
    }
  }
}

}  // namespace

Campus buildCampus(const CampusParams& params) {
  return buildCampus(params, campusFrameOf(params.seed));
}

Campus buildCampus(const CampusParams& params, const CampusFrame& frame) {
  check(params);
  CampusSite site(params, frame);
  makeGround(site);
  layOutBuildings(site);
  plantAvenues(site);
  furnishStreet(site);
  furnishPaths(site);
  plantLawns(site);
  layOutBorders(site);
  noteCrownsAbove(site);
  placeStops(site);
  return std::move(site).finish();
}

}  // namespace cluxel::simulation
