// SPDX-License-Identifier: Apache-2.0
// Generates the triangles of simple bodies.
#include "simulation/makers/mesh_shapes.hpp"

#include <cmath>
#include <numbers>

namespace cluxel::simulation {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;
constexpr double kTurn = 2 * std::numbers::pi;

void addTriangle(CampusMesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3d& corner : {a, b, c}) mesh.vertices.push_back(corner.cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void addQuad(CampusMesh& mesh, const Corners& corners) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3d& corner : corners) mesh.vertices.push_back(corner.cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

void addBox(CampusMesh& mesh, const Isometry3d& T_map_box, const Vector3d& size) {
  const Vector2d half = size.head<2>() / 2;
  addPlate(mesh, T_map_box,
           {{-half.x(), -half.y()}, {half.x(), -half.y()}, {half.x(), half.y()}, {-half.x(), half.y()}}, size.z());
}

void addTube(CampusMesh& mesh, const Tube& tube) {
  const Vector3d axis = (tube.to - tube.from).normalized();
  const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  const auto rim = [&](const Vector3d& center, double radius, int side) -> Vector3d {
    const double angle = kTurn * (side % tube.sides) / tube.sides;
    return center + radius * (std::cos(angle) * u + std::sin(angle) * v);
  };
  for (int i = 0; i < tube.sides; ++i) {
    addQuad(mesh, {rim(tube.from, tube.radius_from, i), rim(tube.from, tube.radius_from, i + 1),
                   rim(tube.to, tube.radius_to, i + 1), rim(tube.to, tube.radius_to, i)});
    if (!tube.capped) continue;
    addTriangle(mesh, tube.to, rim(tube.to, tube.radius_to, i), rim(tube.to, tube.radius_to, i + 1));
    addTriangle(mesh, tube.from, rim(tube.from, tube.radius_from, i + 1), rim(tube.from, tube.radius_from, i));
  }
}

void addEllipsoid(CampusMesh& mesh, const Vector3d& center, const Vector3d& radii) {
  constexpr int kRings = 8, kSides = 12;
  const auto at = [&](int ring, int side) -> Vector3d {
    const double polar = std::numbers::pi * ring / kRings, around = kTurn * (side % kSides) / kSides;
    const Vector3d unit{std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)};
    return center + radii.cwiseProduct(unit);
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int side = 0; side < kSides; ++side)
      addQuad(mesh, {at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)});
}

void addPlate(CampusMesh& mesh, const Isometry3d& T_map_plate, const std::vector<Vector2d>& outline, double thickness) {
  const auto at = [&](std::size_t corner, double side) -> Vector3d {
    const Vector2d& p = outline[corner % outline.size()];
    return T_map_plate * Vector3d{p.x(), p.y(), side * thickness / 2};
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    addQuad(mesh, {at(i, -1), at(i + 1, -1), at(i + 1, 1), at(i, 1)});
    if (i == 0 || i + 1 == outline.size()) continue;
    addTriangle(mesh, at(0, 1), at(i, 1), at(i + 1, 1));
    addTriangle(mesh, at(0, -1), at(i + 1, -1), at(i, -1));
  }
}

std::vector<Vector2d> regularOutline(int corners, double radius, double phase_rad) {
  std::vector<Vector2d> outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = phase_rad + kTurn * i / corners;
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return outline;
}

std::vector<Vector2d> rectangleOutline(double width, double height) {
  return {{-width / 2, -height / 2}, {width / 2, -height / 2}, {width / 2, height / 2}, {-width / 2, height / 2}};
}

Vector3d randomDirection(CampusRandom& random) {
  const double z = random.uniform(-1, 1), around = kTurn * random.uniform(), flat = std::sqrt(1 - z * z);
  return {flat * std::cos(around), flat * std::sin(around), z};
}

void addLeaf(CampusMesh& mesh, CampusRandom& random, const Vector3d& center, double size) {
  const Vector3d u = randomDirection(random), v = u.unitOrthogonal();
  const double reach = size / std::sqrt(3.0);
  addTriangle(mesh, center + reach * u, center + reach * (-0.5 * u + 0.866 * v),
              center + reach * (-0.5 * u - 0.866 * v));
}

void addFramedGlass(CampusMesh& frame, CampusMesh& glass, const Corners& corners, double margin) {
  const auto at = [&](double s, double t) -> Vector3d {
    return (1 - t) * ((1 - s) * corners[0] + s * corners[1]) + t * ((1 - s) * corners[3] + s * corners[2]);
  };
  const double far = 1 - margin;
  const Corners inner{at(margin, margin), at(far, margin), at(far, far), at(margin, far)};
  addQuad(glass, inner);
  for (std::size_t i = 0; i < 4; ++i) addQuad(frame, {corners[i], corners[(i + 1) % 4], inner[(i + 1) % 4], inner[i]});
}

Isometry3d standing(const Vector3d& position, double yaw_rad) {
  return Eigen::Translation3d(position) * Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ());
}

Isometry3d movedBy(const Isometry3d& T, const Vector3d& offset) {
  return T * Eigen::Translation3d(offset);
}

}  // namespace cluxel::simulation
