// SPDX-License-Identifier: Apache-2.0
// Surfaces are compared as triangles seen from above, so that the inside of a closed thing is not free either.
#include "simulation/site/stop_room.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace cluxel::simulation {

namespace {

using Eigen::AlignedBox2d, Eigen::Vector2d, Eigen::Vector3d;
using Triangle = std::array<Vector3d, 3>;

double distanceToEdge(const Vector2d& from, const Vector2d& to, const Vector2d& place) {
  const Vector2d edge = to - from;
  const double along = std::clamp((place - from).dot(edge) / std::max(edge.squaredNorm(), 1e-12), 0.0, 1.0);
  return (from + along * edge - place).norm();
}

/// The distance from a triangle to a place, both seen from above; 0 inside.
double distanceFromAbove(const Triangle& triangle, const Vector2d& place) {
  double nearest = 1e300;
  int left = 0, right = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2d from = triangle[i].head<2>(), to = triangle[(i + 1) % 3].head<2>();
    const Vector2d edge = to - from, step = place - from;
    const double side = edge.x() * step.y() - edge.y() * step.x();
    left += side > 0 ? 1 : 0, right += side < 0 ? 1 : 0;
    nearest = std::min(nearest, distanceToEdge(from, to, place));
  }
  return left == 3 || right == 3 ? 0 : nearest;
}

bool leavesRoom(const Triangle& triangle, const Vector3d& stop) {
  const double lowest = std::min({triangle[0].z(), triangle[1].z(), triangle[2].z()});
  return lowest > stop.z() + kStopRoom_m || distanceFromAbove(triangle, stop.head<2>()) > kStopRoom_m;
}

bool leavesRoom(const CampusMesh& mesh, const Vector3d& stop) {
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& corners) {
    const auto at = [&](std::size_t i) -> Vector3d { return mesh.vertices[corners[i]].template cast<double>(); };
    return leavesRoom({at(0), at(1), at(2)}, stop);
  });
}

/// Whether the bounds of the object are so near that its surfaces must be looked at.
bool mayBeNear(const CampusObject& object, const Vector3d& stop) {
  const AlignedBox2d bounds(object.box.min().head<2>(), object.box.max().head<2>());
  return bounds.exteriorDistance(Vector2d(stop.head<2>())) <= kStopRoom_m;
}

}  // namespace

bool leavesRoom(const Campus& campus, std::int32_t instance, const Vector3d& shift, const Vector3d& stop) {
  const Vector3d seen_from = stop - shift;
  if (!mayBeNear(campus.objects[static_cast<std::size_t>(instance)], seen_from)) return true;
  return std::all_of(campus.meshes.begin(), campus.meshes.end(),
                     [&](const CampusMesh& mesh) { return mesh.instance != instance || leavesRoom(mesh, seen_from); });
}

bool hasRoom(const Campus& campus, const Vector3d& stop) {
  constexpr std::int32_t kGround = 0;  // lower numbers: wires and leaves, which are of no object
  return std::all_of(campus.meshes.begin(), campus.meshes.end(), [&](const CampusMesh& mesh) {
    if (mesh.instance == kGround) return true;
    const bool may_be_near =
        mesh.instance < kGround || mayBeNear(campus.objects[static_cast<std::size_t>(mesh.instance)], stop);
    return !may_be_near || leavesRoom(mesh, stop);
  });
}

}  // namespace cluxel::simulation
