// SPDX-License-Identifier: Apache-2.0
// Bins, benches, bollards, hydrants and people.
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

namespace {

Tube upright(const Vector3d& foot, double low, double high, double radius) {
  return {.from = foot + Vector3d{0, 0, low},
          .to = foot + Vector3d{0, 0, high},
          .radius_from = radius,
          .radius_to = radius,
          .sides = 12};
}

std::int32_t enter(CampusSite& site, const char* kind, const Vector3d& position, double reach_m) {
  return site.addObject(ObjectClass::SmallObject, kind, position, reach_m);
}

}  // namespace

std::int32_t makeBin(CampusSite& site, const Vector2d& place, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = enter(site, "bin", foot, 0.3);
  CampusMesh bin = surfaceOf(SurfaceLabel::Bin, id, {.reflectivity = 0.3F});
  if (random.chance(0.5)) {
    addTube(bin, upright(foot, -0.05, 0.85, random.uniform(0.22, 0.28)));
    addTube(bin, upright(foot, 0.85, 0.95, 0.3));
  } else {
    addBox(bin, movedBy(standing(foot, random.uniform(0, 3)), {0, 0, 0.5}), {0.58, 0.66, 0.95});
  }
  site.addSurface(std::move(bin));
  return id;
}

std::int32_t makeBench(CampusSite& site, const Vector2d& place, double yaw_rad, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = enter(site, "bench", foot, 0.9);
  CampusMesh bench = surfaceOf(SurfaceLabel::Bench, id, {.reflectivity = 0.4F});
  const Isometry3d T = standing(foot, yaw_rad);  // x: where one looks when sitting
  const double width = random.uniform(1.5, 1.9);
  for (const double x : {-0.16, 0.0, 0.16}) addBox(bench, movedBy(T, {x, 0, 0.45}), {0.13, width, 0.04});
  for (const double z : {0.62, 0.78}) addBox(bench, movedBy(T, {-0.28 - 0.1 * z, 0, z}), {0.04, width, 0.12});
  for (const double y : {-0.42 * width, 0.42 * width}) {
    addBox(bench, movedBy(T, {0, y, 0.2}), {0.4, 0.06, 0.46});
    addBox(bench, movedBy(T, {-0.3, y, 0.62}), {0.05, 0.06, 0.5});
  }
  site.addSurface(std::move(bench));
  return id;
}

std::int32_t makeBollard(CampusSite& site, const Vector2d& place, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = enter(site, "bollard", foot, 0.1);
  CampusMesh bollard = surfaceOf(SurfaceLabel::Bollard, id, {.reflectivity = 0.6F});
  const double radius = random.uniform(0.06, 0.1), height = random.uniform(0.85, 1.05);
  addTube(bollard, upright(foot, -0.1, height, radius));
  site.addSurface(std::move(bollard));
  return id;
}

std::int32_t makeHydrant(CampusSite& site, const Vector2d& place, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = enter(site, "hydrant", foot, 0.2);
  CampusMesh hydrant = surfaceOf(SurfaceLabel::Hydrant, id, {.reflectivity = 0.5F});
  addTube(hydrant, upright(foot, -0.1, 0.6, 0.11));
  addTube(hydrant, upright(foot, 0.05, 0.1, 0.17));
  addEllipsoid(hydrant, foot + Vector3d{0, 0, 0.62}, {0.14, 0.14, 0.16});
  const double yaw = random.uniform(0, 6.3);
  const Vector3d side{0.2 * std::cos(yaw), 0.2 * std::sin(yaw), 0}, middle = foot + Vector3d{0, 0, 0.45};
  addTube(hydrant, {.from = middle - side, .to = middle + side, .radius_from = 0.06, .radius_to = 0.06});
  site.addSurface(std::move(hydrant));
  return id;
}

std::int32_t makePerson(CampusSite& site, const Vector2d& place, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = enter(site, "person", foot, 0.3);
  CampusMesh person =
      surfaceOf(SurfaceLabel::Person, id, {.reflectivity = static_cast<float>(random.uniform(0.2, 0.6))});
  const double tall = random.uniform(1.55, 1.9), yaw = random.uniform(0, 6.3);
  const Vector3d side{0.11 * std::cos(yaw), 0.11 * std::sin(yaw), 0};
  for (const double sign : {-1.0, 1.0}) {
    addTube(person, {.from = foot + sign * side,
                     .to = foot + 0.8 * sign * side + Vector3d{0, 0, 0.48 * tall},
                     .radius_from = 0.06,
                     .radius_to = 0.09});
    addTube(person, {.from = foot + 2.0 * sign * side + Vector3d{0, 0, 0.8 * tall},
                     .to = foot + 2.4 * sign * side + Vector3d{0, 0, 0.45 * tall},
                     .radius_from = 0.05,
                     .radius_to = 0.04});
  }
  addEllipsoid(person, foot + Vector3d{0, 0, 0.66 * tall}, {0.2, 0.2, 0.2 * tall});
  addEllipsoid(person, foot + Vector3d{0, 0, 0.93 * tall}, {0.1, 0.1, 0.12});
  site.addSurface(std::move(person));
  return id;
}

}  // namespace cluxel::simulation
