// SPDX-License-Identifier: Apache-2.0
// Bushes, hedges and thickets: leaves near the surface of a body that stands on the ground.
#include <algorithm>
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {

using Eigen::Vector2d, Eigen::Vector3d;

namespace {

/// A random position of a leaf in the outer half of an ellipsoid around the origin.
Vector3d placeInOuterHalf(const Vector3d& radii, CampusRandom& random) {
  const Vector3d direction = randomDirection(random);
  return (0.5 + 0.5 * std::sqrt(random.uniform())) * radii.cwiseProduct(direction);
}

}  // namespace

std::int32_t makeBush(CampusSite& site, const Vector2d& place, double radius, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = site.addObject(ObjectClass::Bush, "bush", foot, radius);
  CampusMesh leaves = surfaceOf(SurfaceLabel::BushTop, id, {.reflectivity = 0.5F});
  const double height = radius * random.uniform(1.1, 1.7);
  const int lobes = 5 + random.below(4);
  for (int lobe = 0; lobe < lobes; ++lobe) {
    const Vector3d direction = randomDirection(random);
    const Vector3d middle = foot + Vector3d{0.45 * radius * direction.x(), 0.45 * radius * direction.y(),
                                            height * random.uniform(0.35, 0.62)};
    const Vector3d radii{0.55 * radius, 0.55 * radius, 0.38 * height};
    const int count = static_cast<int>(480 * radius * radius + 60);
    for (int i = 0; i < count; ++i) {
      const Vector3d leaf = middle + placeInOuterHalf(radii, random);
      addLeaf(leaves, random, leaf, random.uniform(0.05, 0.11));
    }
  }
  site.addSurface(std::move(leaves));
  return id;
}

std::int32_t makeHedge(CampusSite& site, const Vector2d& from, const Vector2d& to, CampusRandom random) {
  const double length = (to - from).norm(), height = random.uniform(0.8, 1.4), half = random.uniform(0.3, 0.45);
  const Vector2d along = (to - from) / length, across{-along.y(), along.x()};
  const std::int32_t id = site.addObject(ObjectClass::Bush, "hedge", site.onGround(0.5 * (from + to)), length / 2);
  CampusMesh leaves = surfaceOf(SurfaceLabel::HedgeTop, id, {.reflectivity = 0.5F});
  const int count = static_cast<int>(length * (2 * height + 2 * half) * 260);
  for (int i = 0; i < count; ++i) {
    const double s = random.uniform(0, length), share = 0.2 * random.uniform(), depth = share * random.uniform();
    double side = random.uniform(-half, half), up = random.uniform(0.05, height);
    if (random.uniform() < half / (half + height))
      up = height - depth;
    else
      side = (side < 0 ? -1 : 1) * (half - depth);
    const Vector2d foot = from + s * along + side * across;
    addLeaf(leaves, random, site.onGround(foot) + Vector3d{0, 0, up}, random.uniform(0.05, 0.1));
  }
  site.addSurface(std::move(leaves));
  return id;
}

namespace {

/// Adds leaves in the outer half of an ellipsoid.
void addLobe(CampusMesh& leaves, const Vector3d& middle, const Vector3d& radii, CampusRandom& random) {
  const int count = static_cast<int>(420 * radii.squaredNorm() / 3 + 50);
  for (int i = 0; i < count; ++i) {
    const double size = random.uniform(0.05, 0.12);
    addLeaf(leaves, random, middle + placeInOuterHalf(radii, random), size);
  }
}

}  // namespace

void makeThicket(CampusSite& site, const Vector2d& from, const Vector2d& to, const ThicketSpec& spec,
                 CampusRandom random) {
  const double length = (to - from).norm();
  const Vector2d along = (to - from) / length, across{-along.y(), along.x()};
  const bool bush = spec.height_m <= kBushTop_m;
  const std::int32_t id =
      bush ? site.addObject(ObjectClass::Bush, "thicket", site.onGround(0.5 * (from + to)), length / 2) : -1;
  CampusMesh leaves = surfaceOf(bush ? SurfaceLabel::HedgeTop : SurfaceLabel::Thicket, id, {.reflectivity = 0.5F});
  const int lobes = 4 + static_cast<int>(1.5 * length * 2 * spec.half_depth_m * spec.height_m);
  for (int lobe = 0; lobe < lobes; ++lobe) {
    const Vector3d radii{random.uniform(0.3, 0.6), random.uniform(0.3, 0.6), random.uniform(0.25, 0.5)};
    const double room = std::max(0.0, spec.half_depth_m - radii.y());
    const double aside = random.uniform(-room, room), way = random.uniform(0, length);
    const Vector2d place = from + way * along + aside * across;
    const double up = random.uniform(0.25, std::max(0.3, spec.height_m - radii.z()));
    addLobe(leaves, site.onGround(place) + Vector3d{0, 0, up}, radii, random);
  }
  site.addSurface(std::move(leaves));
}

}  // namespace cluxel::simulation
