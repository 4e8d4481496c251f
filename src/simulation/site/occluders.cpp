// SPDX-License-Identifier: Apache-2.0
// A van is a body with an opaque cargo box, a windscreen and four wheels; its footprint is compared with all surfaces.
#include "simulation/site/occluders.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulation/makers/mesh_shapes.hpp"
#include "simulation/site/campus_site.hpp"
#include "simulation/site/stop_room.hpp"

namespace cluxel::simulation {

namespace {

using Eigen::AlignedBox2d, Eigen::AlignedBox3d, Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d, Eigen::Vector3f;

// Dimensions of a delivery van [m]; x runs forward from its middle, heights are above the ground.
constexpr double kLength_m = 5.9, kWidth_m = 2.05, kHeight_m = 2.75, kBelt_m = 1.25;
constexpr double kHood_x = 2.35, kWindscreen_x = 1.85;
constexpr double kWheelRadius_m = 0.34;

constexpr double kGap_m = 0.5;        ///< between the van and what it hides
constexpr double kRouteRoom_m = 1.4;  ///< between the van and the robot's route
constexpr double kRoom_m = 0.25;      ///< between the van and other things
constexpr double kFarthest_m = 15;    ///< from the route to what a van hides

using Stops = std::vector<Isometry3d>;

/// Calls `act` with each stop and the way to the next one, for the last with none.
template <typename Act>
void followRoute(const Stops& route, const Act& act) {
  for (std::size_t i = 0; i < route.size(); ++i) {
    const Vector3d from = route[i].translation(), to = route[std::min(i + 1, route.size() - 1)].translation();
    act(from, Vector3d(to - from));
  }
}

/// The place on the route that is nearest to `place`.
Vector2d nearestOnRoute(const Stops& route, const Vector2d& place) {
  Vector2d nearest = route.front().translation().head<2>();
  followRoute(route, [&](const Vector3d& stop, const Vector3d& way) {
    const Vector2d from = stop.head<2>(), step = way.head<2>();
    const double along = std::clamp((place - from).dot(step) / std::max(step.squaredNorm(), 1e-12), 0.0, 1.0);
    const Vector2d candidate = from + along * step;
    if ((candidate - place).norm() < (nearest - place).norm()) nearest = candidate;
  });
  return nearest;
}

/// The space that a van takes, in its own frame.
AlignedBox3d spaceOfVan() {
  constexpr double kAboveGround_m = 0.15;  // the ground itself is not in the way
  const Vector3d half{kLength_m / 2 + kRoom_m, kWidth_m / 2 + kRoom_m, 0};
  return {Vector3d(-half.x(), -half.y(), kAboveGround_m), Vector3d(half.x(), half.y(), kHeight_m + kRoom_m)};
}

bool isFree(const Campus& campus, const Isometry3d& T_map_van) {
  const AlignedBox3d space = spaceOfVan();
  const Isometry3d T_van_map = T_map_van.inverse();
  constexpr std::int32_t kGround = 0;
  for (const CampusMesh& mesh : campus.meshes) {
    if (mesh.instance == kGround) continue;
    std::vector<Vector3d> seen_from_van;
    for (const Vector3f& vertex : mesh.vertices) seen_from_van.push_back(T_van_map * vertex.cast<double>());
    for (const auto& triangle : mesh.triangles) {
      AlignedBox3d bounds;
      for (const std::uint32_t corner : triangle) bounds.extend(seen_from_van[corner]);
      if (bounds.intersects(space)) return false;
    }
  }
  return true;
}

/// Whether the van stays away from the route and from the stops of the visit, which lie beside it.
bool leavesTheRouteFree(const Stops& route, const Stops& stops, const Isometry3d& T_map_van) {
  const AlignedBox2d footprint(Vector2d(-kLength_m / 2, -kWidth_m / 2), Vector2d(kLength_m / 2, kWidth_m / 2));
  const Isometry3d T_van_map = T_map_van.inverse();
  const auto distanceTo = [&](const Vector3d& place) {
    const Vector3d seen_from_van = T_van_map * place;
    return footprint.exteriorDistance(Vector2d(seen_from_van.head<2>()));
  };
  constexpr double kStep_m = 0.5;
  bool is_free = true;
  followRoute(route, [&](const Vector3d& from, const Vector3d& step) {
    const int pieces = 1 + static_cast<int>(step.norm() / kStep_m);
    for (int piece = 0; piece <= pieces && is_free; ++piece)
      is_free = distanceTo(from + step * piece / pieces) >= kRouteRoom_m;
  });
  return is_free && std::none_of(stops.begin(), stops.end(),
                                 [&](const Isometry3d& stop) { return distanceTo(stop.translation()) <= kStopRoom_m; });
}

/// Half of the box's extent along a direction.
double halfAlong(const AlignedBox3d& box, const Vector2d& direction) {
  return 0.5 * box.sizes().head<2>().dot(direction.cwiseAbs());
}

void addBody(CampusMesh& body, CampusMesh& glass, const Isometry3d& T_map_van) {
  const double front = kLength_m / 2, rear = -front, side = kWidth_m / 2;
  Isometry3d T_van_side = Isometry3d::Identity();
  T_van_side.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  addPlate(body, T_map_van * T_van_side,
           {{rear, 0.3}, {front - 0.1, 0.25}, {front, 0.9}, {kHood_x, kBelt_m}, {rear, kBelt_m}}, kWidth_m);
  const auto at = [&](double x, double y, double z) -> Vector3d { return T_map_van * Vector3d{x, y, z}; };
  for (const double y : {-side, side})
    addQuad(body,
            {at(rear, y, kBelt_m), at(kHood_x, y, kBelt_m), at(kWindscreen_x, y, kHeight_m), at(rear, y, kHeight_m)});
  addQuad(body, {at(rear, -side, kHeight_m), at(kWindscreen_x, -side, kHeight_m), at(kWindscreen_x, side, kHeight_m),
                 at(rear, side, kHeight_m)});
  addQuad(body,
          {at(rear, -side, kBelt_m), at(rear, side, kBelt_m), at(rear, side, kHeight_m), at(rear, -side, kHeight_m)});
  addFramedGlass(body, glass,
                 {at(kHood_x, -side, kBelt_m), at(kHood_x, side, kBelt_m), at(kWindscreen_x, side, kHeight_m),
                  at(kWindscreen_x, -side, kHeight_m)},
                 0.12);
}

void addWheels(CampusMesh& wheels, const Isometry3d& T_map_van) {
  for (const double x : {kLength_m / 2 - 1.0, -kLength_m / 2 + 1.1})
    for (const double side : {-1.0, 1.0}) {
      const double inner = side * (kWidth_m / 2 - 0.25), outer = side * (kWidth_m / 2 + 0.02);
      addTube(wheels, {.from = T_map_van * Vector3d{x, inner, kWheelRadius_m},
                       .to = T_map_van * Vector3d{x, outer, kWheelRadius_m},
                       .radius_from = kWheelRadius_m,
                       .radius_to = kWheelRadius_m,
                       .sides = 16});
    }
}

}  // namespace

bool canBeHidden(const CampusObject& object) {
  const bool is_low = object.box.max().z() - object.position.z() < kHeight_m;
  const auto is = [&object](ObjectClass one) { return object.class_number == static_cast<int>(one); };
  return is_low && (is(ObjectClass::StreetSign) || is(ObjectClass::Bush) || is(ObjectClass::SmallObject));
}

std::optional<Isometry3d> placeOfVan(const Campus& campus, const Stops& route, const CampusObject& hidden) {
  const Vector2d middle = hidden.box.center().head<2>(), from = nearestOnRoute(route, middle);
  const double distance = (middle - from).norm();
  if (distance < kRouteRoom_m + kWidth_m || distance > kFarthest_m) return std::nullopt;
  const Vector2d outwards = (middle - from).normalized();
  const Vector2d place = middle - outwards * (halfAlong(hidden.box, outwards) + kGap_m + kWidth_m / 2);
  const auto terrain_at = [&](const Vector2d& at) { return campus.terrain.heightAt(at.x(), at.y()); };
  const double height = hidden.position.z() + terrain_at(place) - terrain_at(hidden.position.head<2>());
  const Isometry3d T_map_van =
      standing({place.x(), place.y(), height}, std::atan2(outwards.x(), -outwards.y()));  // along the route
  if (!leavesTheRouteFree(route, campus.stops, T_map_van) || !isFree(campus, T_map_van)) return std::nullopt;
  return T_map_van;
}

std::int32_t addVan(Campus& campus, const Isometry3d& T_map_van, CampusRandom random) {
  const auto van = static_cast<std::int32_t>(campus.objects.size());
  CampusMesh body =
      surfaceOf(SurfaceLabel::CarBody, van, {.reflectivity = static_cast<float>(random.uniform(0.3, 0.8))});
  CampusMesh glass = surfaceOf(SurfaceLabel::CarWindow, van, {.reflectivity = 0.08F, .transparency = 0.75F});
  CampusMesh wheels = surfaceOf(SurfaceLabel::CarWheel, van, {.reflectivity = 0.08F});
  addBody(body, glass, T_map_van);
  addWheels(wheels, T_map_van);
  CampusObject object{.class_number = static_cast<int>(ObjectClass::Vehicle),
                      .kind = "delivery van",
                      .position = T_map_van.translation(),
                      .box = {},
                      .reach_m = kLength_m / 2,
                      .traits = {"occluder"}};
  for (CampusMesh* mesh : {&body, &glass, &wheels}) {
    for (const Vector3f& vertex : mesh->vertices) object.box.extend(vertex.cast<double>());
    campus.meshes.push_back(std::move(*mesh));
  }
  campus.objects.push_back(std::move(object));
  return van;
}

}  // namespace cluxel::simulation
