// SPDX-License-Identifier: Apache-2.0
// Street signs: a thin pole with one or two round, rectangular or triangular plates, sometimes partly covered by
// leaves.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

struct PlateOutline {
  std::vector<Vector2d> corners;  ///< x to the side, y up
  double half_height_m = 0.3;
};

PlateOutline randomPlate(CampusRandom& random) {
  using std::numbers::pi;
  switch (random.below(4)) {
    case 0:
      return {regularOutline(20, 0.3, 0), 0.3};
    case 1:
      return {regularOutline(3, 0.48, (random.chance(0.8) ? 0.5 : -0.5) * pi), 0.42};
    case 2:
      return {regularOutline(8, 0.36, pi / 8), 0.34};
    default:
      break;
  }
  const double width = random.uniform(0.45, 0.9), height = random.uniform(0.4, 0.75);
  return {rectangleOutline(width, height), height / 2};
}

/// The pose of an upright plate that faces `yaw_rad`: x to the side, y up, z forward.
Eigen::Isometry3d uprightPlate(const Vector3d& center, double yaw_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().col(0) = Vector3d{-std::sin(yaw_rad), std::cos(yaw_rad), 0};
  T.linear().col(1) = Vector3d::UnitZ();
  T.linear().col(2) = Vector3d{std::cos(yaw_rad), std::sin(yaw_rad), 0};
  T.translation() = center;
  return T;
}

void addLeaves(CampusSite& site, const Vector3d& top, CampusRandom& random) {
  CampusMesh leaves = surfaceOf(SurfaceLabel::LeafClutter, -1, {.reflectivity = 0.5F});
  for (int i = 0; i < 320; ++i) {
    const Vector3d spread = Vector3d{0.5, 0.5, 0.35} * std::cbrt(random.uniform());
    const double size = random.uniform(0.05, 0.1);
    addLeaf(leaves, random, top + Vector3d{0, 0, 0.15} + spread.cwiseProduct(randomDirection(random)), size);
  }
  site.addSurface(std::move(leaves));
}

}  // namespace

std::int32_t makeSign(CampusSite& site, const Vector2d& place, const SignSpec& spec, CampusRandom random) {
  const Vector3d foot = site.onGround(place), up = Vector3d::UnitZ();
  const Vector3d ahead{std::cos(spec.yaw_rad), std::sin(spec.yaw_rad), 0};
  const std::int32_t id = site.addObject(ObjectClass::StreetSign, "street sign", foot, 0.1);
  CampusMesh pole = surfaceOf(SurfaceLabel::SignPole, id, {.reflectivity = 0.5F});
  CampusMesh plate = surfaceOf(SurfaceLabel::SignPlate, id, {.reflectivity = 0.95F});
  const double radius = random.uniform(0.028, 0.04);
  double low = random.uniform(1.9, 2.3);
  for (int i = 0; i < spec.plates; ++i) {
    const PlateOutline outline = randomPlate(random);
    const Vector3d center = foot + (low + outline.half_height_m) * up + (radius + 0.015) * ahead;
    addPlate(plate, uprightPlate(center, spec.yaw_rad), outline.corners, 0.02);
    low += 2 * outline.half_height_m + 0.06;
  }
  addTube(pole, {.from = foot - 0.2 * up, .to = foot + low * up, .radius_from = radius, .radius_to = radius});
  site.addSurface(std::move(pole));
  site.addSurface(std::move(plate));
  if (spec.plates > 1) site.addTrait(id, "two plates");
  if (spec.leaves) {
    addLeaves(site, foot + low * up, random);
    site.addTrait(id, "leaves on top");
  }
  return id;
}

}  // namespace cluxel::simulation
