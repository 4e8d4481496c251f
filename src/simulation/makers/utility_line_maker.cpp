// SPDX-License-Identifier: Apache-2.0
// Utility lines: wooden poles with crossarms and sagging wires.
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

/// The line runs along x and the crossarms along y.
Vector3d makePole(CampusSite& site, const Vector2d& place, CampusRandom& random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = site.addObject(ObjectClass::UtilityPole, "utility pole", foot, 0.2);
  CampusMesh pole = surfaceOf(SurfaceLabel::UtilityPole, id, {.reflectivity = 0.3F});
  CampusMesh arms = surfaceOf(SurfaceLabel::Crossarm, id, {.reflectivity = 0.3F});
  const double height = random.uniform(8.2, 9.4), radius = random.uniform(0.12, 0.16);
  const Vector3d top = foot + Vector3d{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), height};
  addTube(
      pole,
      {.from = foot - Vector3d{0, 0, 0.3}, .to = top, .radius_from = radius, .radius_to = 0.75 * radius, .sides = 12});
  const int count = 1 + random.below(2);
  for (int i = 0; i < count; ++i) {
    const Vector3d middle = top - Vector3d{0, 0, 0.4 + 0.8 * i};
    addBox(arms, standing(middle, 0), {0.1, 2.0, 0.12});
    for (const double side : {-0.9, 0.9})
      addTube(arms, {.from = middle + Vector3d{0, side, 0},
                     .to = middle + Vector3d{0, side, 0.22},
                     .radius_from = 0.05,
                     .radius_to = 0.05,
                     .sides = 6});
  }
  site.addSurface(std::move(pole));
  site.addSurface(std::move(arms));
  return top - Vector3d{0, 0, 0.18};
}

/// A wire between two fixings: a parabola of thin tube segments.
void addWire(CampusMesh& wires, const Vector3d& from, const Vector3d& to, double sag) {
  constexpr int kPieces = 16;
  const auto at = [&](int piece) -> Vector3d {
    const double s = static_cast<double>(piece) / kPieces;
    return (1 - s) * from + s * to - Vector3d{0, 0, 4 * sag * s * (1 - s)};
  };
  for (int piece = 0; piece < kPieces; ++piece)
    addTube(wires, {.from = at(piece),
                    .to = at(piece + 1),
                    .radius_from = 0.015,
                    .radius_to = 0.015,
                    .sides = 4,
                    .capped = false});
}

}  // namespace

void makeUtilityLine(CampusSite& site, const std::vector<Vector2d>& places, CampusRandom random) {
  std::vector<Vector3d> tops;
  for (const Vector2d& place : places) tops.push_back(makePole(site, place, random));
  CampusMesh wires = surfaceOf(SurfaceLabel::Wire, -1, {.reflectivity = 0.3F});
  for (std::size_t i = 0; i + 1 < tops.size(); ++i)
    for (const double side : {-0.9, 0.9})
      addWire(wires, tops[i] + Vector3d{0, side, 0}, tops[i + 1] + Vector3d{0, side, 0}, random.uniform(0.3, 0.6));
  site.addSurface(std::move(wires));
}

}  // namespace cluxel::simulation
