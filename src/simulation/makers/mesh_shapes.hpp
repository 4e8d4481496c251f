// SPDX-License-Identifier: Apache-2.0
// Triangle meshes of boxes, tubes, balls, plates and leaves. All lengths are in metres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "simulation/site/campus.hpp"
#include "simulation/site/campus_random.hpp"

namespace cluxel::simulation {

using Corners = std::array<Eigen::Vector3d, 4>;

void addTriangle(CampusMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);
/// The corners are given in order around the quad.
void addQuad(CampusMesh& mesh, const Corners& corners);

/// A box of the given size around the origin of T_map_box.
void addBox(CampusMesh& mesh, const Eigen::Isometry3d& T_map_box, const Eigen::Vector3d& size);

struct Tube {
  Eigen::Vector3d from, to;
  double radius_from = 0.1, radius_to = 0.1;
  int sides = 10;
  bool capped = true;
};
void addTube(CampusMesh& mesh, const Tube& tube);

void addEllipsoid(CampusMesh& mesh, const Eigen::Vector3d& center, const Eigen::Vector3d& radii);

/// A convex outline in the x-y plane of T_map_plate, thickened to both sides along z.
void addPlate(CampusMesh& mesh, const Eigen::Isometry3d& T_map_plate, const std::vector<Eigen::Vector2d>& outline,
              double thickness);
/// A regular outline for addPlate; the first corner at `phase_rad`.
std::vector<Eigen::Vector2d> regularOutline(int corners, double radius, double phase_rad);
/// An upright rectangle for addPlate.
std::vector<Eigen::Vector2d> rectangleOutline(double width, double height);

/// One triangle of edge length `size` around `center`, in a random orientation.
void addLeaf(CampusMesh& mesh, CampusRandom& random, const Eigen::Vector3d& center, double size);

/// A random direction, uniform on the sphere.
Eigen::Vector3d randomDirection(CampusRandom& random);

/// A framed pane: the inner quad is added to `glass`, the four strips around it to `frame`. `margin` is a share of the
/// edge lengths.
void addFramedGlass(CampusMesh& frame, CampusMesh& glass, const Corners& corners, double margin);

/// The pose at `position`, rotated by `yaw_rad` about the vertical axis.
Eigen::Isometry3d standing(const Eigen::Vector3d& position, double yaw_rad);
/// `T` translated by `offset` in its own frame.
Eigen::Isometry3d movedBy(const Eigen::Isometry3d& T, const Eigen::Vector3d& offset);

}  // namespace cluxel::simulation
