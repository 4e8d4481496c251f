// SPDX-License-Identifier: Apache-2.0
// Bicycles and motorcycles: two wheels and a thin frame.
#include <cmath>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

namespace {

/// Parts of a cycle in its own frame: x forward, z up, origin on the ground between the wheels.
class CycleBody {
 public:
  CycleBody(CampusMesh& mesh, const Isometry3d& T_map_cycle) : mesh_(mesh), T_(T_map_cycle) {}

  void bar(const Vector3d& from, const Vector3d& to, double radius) {
    addTube(mesh_, {.from = T_ * from, .to = T_ * to, .radius_from = radius, .radius_to = radius, .sides = 6});
  }
  void body(const Vector3d& middle, const Vector3d& radii) {
    const std::size_t first = mesh_.vertices.size();
    addEllipsoid(mesh_, Vector3d::Zero(), radii);
    for (std::size_t i = first; i < mesh_.vertices.size(); ++i)
      mesh_.vertices[i] = (T_ * (middle + mesh_.vertices[i].cast<double>())).cast<float>();
  }
  void wheel(double x, double radius, double tyre, int spokes) {
    constexpr int kPieces = 18;
    const auto rim = [&](double share, double r) {
      const double angle = 2 * std::numbers::pi * share;
      return Vector3d{x + r * std::cos(angle), 0, radius + r * std::sin(angle)};
    };
    for (int i = 0; i < kPieces; ++i)
      bar(rim(static_cast<double>(i) / kPieces, radius - tyre), rim((i + 1.0) / kPieces, radius - tyre), tyre);
    for (int i = 0; i < spokes; ++i) bar({x, 0, radius}, rim(static_cast<double>(i) / spokes, radius - tyre), 0.004);
  }

 private:
  CampusMesh& mesh_;
  Isometry3d T_;
};

void addBicycle(CycleBody& cycle, CampusRandom& random) {
  const double wheel = random.uniform(0.31, 0.35), base = random.uniform(0.5, 0.55), saddle = random.uniform(0.82, 1.0);
  cycle.wheel(base, wheel, 0.02, 14);
  cycle.wheel(-base, wheel, 0.02, 14);
  const Vector3d crank{-0.08, 0, 0.28}, head{0.36, 0, 0.82}, seat{-0.24, 0, saddle}, hub{-base, 0, wheel},
      fork{base, 0, wheel};
  cycle.bar(crank, seat, 0.018);
  cycle.bar(crank, head, 0.02);
  cycle.bar(0.85 * seat + 0.15 * crank, head, 0.018);
  cycle.bar(crank, hub, 0.012);
  cycle.bar(0.85 * seat + 0.15 * crank, hub, 0.012);
  cycle.bar(fork, head + Vector3d{-0.04, 0, 0.16}, 0.016);
  cycle.bar(head + Vector3d{-0.02, -0.3, 0.2}, head + Vector3d{-0.02, 0.3, 0.2}, 0.014);
  cycle.body(seat + Vector3d{-0.02, 0, 0.03}, {0.14, 0.08, 0.04});
  if (random.chance(0.4)) cycle.body({0.62, 0, 0.85}, {0.16, 0.18, 0.13});  // a basket
  if (random.chance(0.4)) cycle.body({-0.5, 0, 0.62}, {0.2, 0.2, 0.18});    // bags
}

void addMotorcycle(CycleBody& cycle, CampusRandom& random) {
  const double wheel = random.uniform(0.26, 0.32), base = random.uniform(0.62, 0.74);
  cycle.wheel(base, wheel, 0.06, 8);
  cycle.wheel(-base, wheel, 0.07, 8);
  cycle.body({0.0, 0, 0.48}, {0.34, 0.2, 0.24});
  cycle.body({0.16, 0, 0.82}, {0.28, 0.16, 0.14});
  cycle.body({-0.38, 0, 0.78}, {0.36, 0.14, 0.09});
  if (random.chance(0.6)) cycle.body({0.55, 0, 0.8}, {0.16, 0.22, 0.26});  // a fairing
  for (const double side : {-0.1, 0.1}) cycle.bar({base, side, wheel}, {0.42, side, 0.95}, 0.025);
  cycle.bar({0.36, -0.36, 1.02}, {0.36, 0.36, 1.02}, 0.02);
  cycle.bar({-0.7, -0.16, 0.36}, {0.1, -0.16, 0.3}, 0.05);
}

}  // namespace

std::int32_t makeCycle(CampusSite& site, const Vector2d& place, double yaw_rad, CycleKind kind, CampusRandom random) {
  const bool motor = kind == CycleKind::Motorcycle;
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = site.addObject(ObjectClass::SmallObject, motor ? "motorcycle" : "bicycle", foot, 1.0);
  CampusMesh mesh = surfaceOf(motor ? SurfaceLabel::Motorcycle : SurfaceLabel::Bicycle, id, {.reflectivity = 0.35F});
  const double lean = random.uniform(0.06, 0.16);  // on its stand
  CycleBody cycle(mesh, standing(foot, yaw_rad) * Eigen::AngleAxisd(lean, Vector3d::UnitX()));
  if (motor)
    addMotorcycle(cycle, random);
  else
    addBicycle(cycle, random);
  site.addSurface(std::move(mesh));
  return id;
}

}  // namespace cluxel::simulation
