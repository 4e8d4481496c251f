// SPDX-License-Identifier: Apache-2.0
// Cars: a lower body extruded from its side view, a tapered cabin with framed windows, four wheels.
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

/// Dimensions of a car [m]. x runs forward from the middle of the car, heights are above the road.
struct CarShape {
  const char* kind;
  double length, width, height;
  double belt;                     ///< height of the lower edge of the windows
  double hood_x, windscreen_x;     ///< foot and top of the windscreen
  double rear_top_x, rear_foot_x;  ///< top and foot of the rear window
};

CarShape randomShape(CampusRandom& random) {
  const auto near = [&random](double value) { return value * random.uniform(0.96, 1.04); };
  switch (random.below(4)) {
    case 0:
      return {"saloon", near(4.6), near(1.8), near(1.45), 0.92, 0.95, 0.3, -1.15, -1.75};
    case 1:
      return {"compact car", near(3.9), near(1.7), near(1.5), 0.95, 0.9, 0.35, -1.5, -1.85};
    case 2:
      return {"van", near(4.9), near(1.95), near(2.05), 1.15, 1.75, 1.25, -2.3, -2.4};
    default:
      return {"off-road car", near(4.5), near(1.9), near(1.75), 1.08, 0.95, 0.5, -1.9, -2.15};
  }
}

/// Extrudes the side view (x-z plane) over the width of the car.
void addLowerBody(CampusMesh& body, const Isometry3d& T_map_car, const CarShape& shape) {
  const double front = shape.length / 2, rear = -front, hood = shape.belt - 0.04;
  const std::vector<Vector2d> outline{
      {rear + 0.1, 0.22},         {front - 0.12, 0.22},      {front, 0.4}, {front - 0.06, hood - 0.22},
      {shape.hood_x, shape.belt}, {rear + 0.04, shape.belt}, {rear, 0.5}};
  Isometry3d T_car_side = Isometry3d::Identity();
  T_car_side.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  addPlate(body, T_map_car * T_car_side, outline, shape.width);
}

void addCabin(CampusMesh& body, CampusMesh& glass, const Isometry3d& T_map_car, const CarShape& shape) {
  const double wide = shape.width / 2 - 0.03, narrow = shape.width / 2 - 0.2;
  const auto at = [&](double x, double y, double z) -> Vector3d { return T_map_car * Vector3d{x, y, z}; };
  const auto foot = [&](double x, double side) { return at(x, side * wide, shape.belt); };
  const auto top = [&](double x, double side) { return at(x, side * narrow, shape.height); };
  const double rear_foot = std::max(shape.rear_foot_x, -shape.length / 2 + 0.06);
  for (const double side : {-1.0, 1.0})
    addFramedGlass(
        body, glass,
        {foot(rear_foot, side), foot(shape.hood_x, side), top(shape.windscreen_x, side), top(shape.rear_top_x, side)},
        0.12);
  addFramedGlass(
      body, glass,
      {foot(shape.hood_x, -1), foot(shape.hood_x, 1), top(shape.windscreen_x, 1), top(shape.windscreen_x, -1)}, 0.07);
  addFramedGlass(body, glass,
                 {foot(rear_foot, -1), foot(rear_foot, 1), top(shape.rear_top_x, 1), top(shape.rear_top_x, -1)}, 0.1);
  addQuad(body, {top(shape.rear_top_x, -1), top(shape.windscreen_x, -1), top(shape.windscreen_x, 1),
                 top(shape.rear_top_x, 1)});
}

void addWheels(CampusMesh& wheels, const Isometry3d& T_map_car, const CarShape& shape) {
  constexpr double kRadius = 0.32;
  for (const double x : {shape.length / 2 - 0.8, -shape.length / 2 + 0.8})
    for (const double side : {-1.0, 1.0}) {
      const double inner = side * (shape.width / 2 - 0.2), outer = side * (shape.width / 2 + 0.02);
      addTube(wheels, {.from = T_map_car * Vector3d{x, inner, kRadius},
                       .to = T_map_car * Vector3d{x, outer, kRadius},
                       .radius_from = kRadius,
                       .radius_to = kRadius,
                       .sides = 16});
    }
}

/// The pose of a car on the road, tilted by the road's slope.
Isometry3d carPose(const CampusSite& site, const Vector2d& place, double yaw_rad) {
  const Vector2d ahead{std::cos(yaw_rad), std::sin(yaw_rad)}, left{-ahead.y(), ahead.x()};
  const Vector3d x = (site.onGround(place + 1.4 * ahead) - site.onGround(place - 1.4 * ahead)).normalized();
  const Vector3d y = (site.onGround(place + 0.8 * left) - site.onGround(place - 0.8 * left));
  Isometry3d T_map_car = Isometry3d::Identity();
  T_map_car.linear().col(0) = x;
  T_map_car.linear().col(2) = x.cross(y).normalized();
  T_map_car.linear().col(1) = T_map_car.linear().col(2).cross(x);
  T_map_car.translation() = site.onGround(place);
  return T_map_car;
}

}  // namespace

std::int32_t makeCar(CampusSite& site, const Vector2d& place, double yaw_rad, CampusRandom random) {
  const CarShape shape = randomShape(random);
  const std::int32_t id = site.addObject(ObjectClass::Vehicle, shape.kind, site.onGround(place), shape.length / 2);
  CampusMesh body =
      surfaceOf(SurfaceLabel::CarBody, id, {.reflectivity = static_cast<float>(random.uniform(0.1, 0.8))});
  CampusMesh glass = surfaceOf(SurfaceLabel::CarWindow, id, {.reflectivity = 0.08F, .transparency = 0.75F});
  CampusMesh wheels = surfaceOf(SurfaceLabel::CarWheel, id, {.reflectivity = 0.08F});
  const Isometry3d T_map_car = carPose(site, place, yaw_rad);
  addLowerBody(body, T_map_car, shape);
  addCabin(body, glass, T_map_car, shape);
  addWheels(wheels, T_map_car, shape);
  for (CampusMesh* surface : {&body, &glass, &wheels}) site.addSurface(std::move(*surface));
  return id;
}

}  // namespace cluxel::simulation
