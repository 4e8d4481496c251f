// SPDX-License-Identifier: Apache-2.0
// Street lamps: posts with a lantern, and tall ones with an arm over the street.
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

struct Lamp {
  Lamp(CampusSite& site, const char* kind, const Vector3d& foot)
      : id(site.addObject(ObjectClass::StreetLamp, kind, foot, 0.15)),
        pole(surfaceOf(SurfaceLabel::LampPole, id, {.reflectivity = 0.4F})),
        arm(surfaceOf(SurfaceLabel::LampArm, id, {.reflectivity = 0.4F})),
        head(surfaceOf(SurfaceLabel::LampHead, id, {.reflectivity = 0.5F})) {}
  std::int32_t addTo(CampusSite& site) {
    for (CampusMesh* surface : {&pole, &arm, &head}) site.addSurface(std::move(*surface));
    return id;
  }

  std::int32_t id;
  CampusMesh pole, arm, head;
};

/// A pole that tapers above a thick base.
void addPole(CampusMesh& mesh, const Vector3d& foot, double height, double radius) {
  const Vector3d up = Vector3d::UnitZ();
  addTube(mesh, {.from = foot - 0.2 * up,
                 .to = foot + 0.7 * up,
                 .radius_from = 1.5 * radius,
                 .radius_to = 1.5 * radius,
                 .sides = 12});
  addTube(mesh, {.from = foot + 0.7 * up,
                 .to = foot + height * up,
                 .radius_from = radius,
                 .radius_to = 0.7 * radius,
                 .sides = 12});
}

}  // namespace

std::int32_t makeStraightLamp(CampusSite& site, const Vector2d& place, CampusRandom random) {
  const Vector3d foot = site.onGround(place), up = Vector3d::UnitZ();
  Lamp lamp(site, "post lamp", foot);
  const double height = random.uniform(3.6, 4.8);
  addPole(lamp.pole, foot, height, random.uniform(0.05, 0.07));
  const Vector3d top = foot + height * up;
  switch (random.below(3)) {
    case 0:
      addEllipsoid(lamp.head, top + 0.2 * up, {0.24, 0.24, 0.24});
      break;
    case 1:
      addTube(lamp.head,
              {.from = top - 0.05 * up, .to = top + 0.45 * up, .radius_from = 0.12, .radius_to = 0.24, .sides = 12});
      addTube(lamp.head,
              {.from = top + 0.45 * up, .to = top + 0.62 * up, .radius_from = 0.3, .radius_to = 0.05, .sides = 12});
      break;
    default:
      addTube(lamp.head, {.from = top, .to = top + 0.14 * up, .radius_from = 0.36, .radius_to = 0.28, .sides = 14});
  }
  return lamp.addTo(site);
}

std::int32_t makeArmLamp(CampusSite& site, const Vector2d& place, double yaw_rad, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  Lamp lamp(site, "lamp with arm", foot);
  const double height = random.uniform(6.2, 7.8), reach = random.uniform(1.1, 1.9);
  addPole(lamp.pole, foot, height, random.uniform(0.07, 0.09));
  const Vector3d ahead{std::cos(yaw_rad), std::sin(yaw_rad), 0};
  const Vector3d top = foot + Vector3d{0, 0, height - 0.05}, tip = top + reach * ahead + Vector3d{0, 0, 0.18 * reach};
  addTube(lamp.arm, {.from = top, .to = tip, .radius_from = 0.045, .radius_to = 0.035, .sides = 8});
  addBox(lamp.head, standing(tip + 0.25 * ahead, yaw_rad), {0.75, 0.3, 0.14});
  return lamp.addTo(site);
}

}  // namespace cluxel::simulation
