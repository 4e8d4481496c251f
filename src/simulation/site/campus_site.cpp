// SPDX-License-Identifier: Apache-2.0
// Reserves ground and collects the objects of a campus under construction.
#include "simulation/site/campus_site.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cluxel::simulation {

using Eigen::Vector2d, Eigen::Vector3d;

CampusMesh surfaceOf(SurfaceLabel label, std::int32_t instance, const SurfaceLook& look) {
  CampusMesh mesh;
  mesh.label = label;
  mesh.instance = instance;
  mesh.reflectivity = look.reflectivity;
  mesh.transparency = look.transparency;
  return mesh;
}

namespace {

Terrain terrainOf(std::uint64_t seed) {
  CampusRandom random = streamOf(seed, RandomUse::Terrain);
  Terrain terrain;
  terrain.slope = {random.uniform(-0.025, 0.025), random.uniform(-0.025, 0.025)};
  for (Terrain::Wave& wave : terrain.waves) {
    const double length_m = random.uniform(32, 75), heading = 2 * std::numbers::pi * random.uniform();
    wave.wave_number = Vector2d{std::cos(heading), std::sin(heading)} * (2 * std::numbers::pi / length_m);
    wave.amplitude_m = random.uniform(0.08, 0.28);
    wave.phase_rad = 2 * std::numbers::pi * random.uniform();
  }
  return terrain;
}

}  // namespace

CampusFrame campusFrameOf(std::uint64_t seed) {
  const double heading = streamOf(seed, RandomUse::Placement, 0).uniform(-std::numbers::pi, std::numbers::pi);
  return {.terrain = terrainOf(seed), .heading_rad = heading};
}

CampusSite::CampusSite(const CampusParams& params, const CampusFrame& frame)
    : heading_rad_(frame.heading_rad), plan_(params.size_m) {
  campus_.params = params;
  campus_.terrain = frame.terrain;
}

Vector3d CampusSite::onGround(const Vector2d& place) const {
  return {place.x(), place.y(), campus_.terrain.heightAt(place.x(), place.y()) + plan_.offsetAt(place.x(), place.y())};
}

bool CampusSite::isFree(const Disc& disc) const {
  constexpr double kRobotRoom_m = 0.9;
  if (plan_.distanceToRoute(disc.center) < disc.radius + kRobotRoom_m) return false;
  if (distanceToBuildings(disc.center) < disc.radius) return false;
  return std::none_of(taken_.begin(), taken_.end(), [&disc](const Disc& other) {
    return (other.center - disc.center).norm() < other.radius + disc.radius;
  });
}

bool CampusSite::claim(const Vector2d& center, double radius) {
  if (!isFree({center, radius})) return false;
  taken_.push_back({center, radius});
  return true;
}

bool CampusSite::claimStrip(const Vector2d& from, const Vector2d& to, double half_width) {
  std::vector<Disc> strip;
  const int pieces = 1 + static_cast<int>((to - from).norm() / half_width);
  for (int piece = 0; piece <= pieces; ++piece) strip.push_back({from + (to - from) * piece / pieces, half_width});
  if (!std::all_of(strip.begin(), strip.end(), [this](const Disc& disc) { return isFree(disc); })) return false;
  taken_.insert(taken_.end(), strip.begin(), strip.end());
  return true;
}

void CampusSite::reserve(const Eigen::AlignedBox2d& rectangle) {
  reserved_.push_back(rectangle);
}

double CampusSite::distanceToBuildings(const Vector2d& place) const {
  double nearest = 1e9;
  for (const auto& rectangle : reserved_) nearest = std::min(nearest, rectangle.exteriorDistance(place));
  return nearest;
}

bool CampusSite::touchesCrown(const Vector2d& center, double radius) const {
  return std::any_of(campus_.objects.begin(), campus_.objects.end(), [&](const CampusObject& object) {
    return object.class_number == static_cast<int>(ObjectClass::Tree) &&
           (object.position.head<2>() - center).norm() < radius + object.reach_m + 0.3;
  });
}

std::int32_t CampusSite::addObject(ObjectClass object_class, std::string kind, const Vector3d& position,
                                   double reach_m) {
  CampusObject object;
  object.class_number = static_cast<int>(object_class);
  object.kind = std::move(kind);
  object.position = position;
  object.reach_m = reach_m;
  campus_.objects.push_back(std::move(object));
  return static_cast<std::int32_t>(campus_.objects.size()) - 1;
}

void CampusSite::addTrait(std::int32_t instance, std::string trait) {
  campus_.objects.at(static_cast<std::size_t>(instance)).traits.push_back(std::move(trait));
}

void CampusSite::addSurface(CampusMesh surface) {
  if (surface.triangles.empty()) return;
  campus_.meshes.push_back(std::move(surface));
}

namespace {

void turn(Campus& campus, const Eigen::Isometry3d& T_map_plan) {
  const Eigen::Matrix2d turned = T_map_plan.linear().topLeftCorner<2, 2>();
  campus.terrain.slope = turned * campus.terrain.slope;
  for (Terrain::Wave& wave : campus.terrain.waves) wave.wave_number = turned * wave.wave_number;
  for (Eigen::Isometry3d& stop : campus.stops) stop = T_map_plan * stop;
  for (CampusObject& object : campus.objects) {
    object.position = T_map_plan * object.position;
    object.box.setEmpty();
  }
  for (CampusMesh& mesh : campus.meshes)
    for (Eigen::Vector3f& vertex : mesh.vertices) {
      vertex = (T_map_plan * vertex.cast<double>()).cast<float>();
      if (mesh.instance >= 0) campus.objects[static_cast<std::size_t>(mesh.instance)].box.extend(vertex.cast<double>());
    }
}

}  // namespace

Campus CampusSite::finish() && {
  campus_.heading_rad = heading_rad_;
  turn(campus_, standing(Vector3d::Zero(), campus_.heading_rad));
  return std::move(campus_);
}

}  // namespace cluxel::simulation
