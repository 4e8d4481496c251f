// SPDX-License-Identifier: Apache-2.0
// The ground as a grid of quads, one mesh per surface type.
#include <map>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector3d;

SurfaceLook lookOf(SurfaceLabel kind) {
  switch (kind) {
    case SurfaceLabel::Lawn:
      return {.reflectivity = 0.45F};
    case SurfaceLabel::Path:
      return {.reflectivity = 0.35F};
    case SurfaceLabel::Street:
      return {.reflectivity = 0.12F};
    case SurfaceLabel::Crossing:
      return {.reflectivity = 0.75F};
    case SurfaceLabel::Kerb:
      return {.reflectivity = 0.4F};
    default:
      return {.reflectivity = 0.28F};
  }
}

/// The grid's corners, with random roughness on grass.
class GroundGrid {
 public:
  explicit GroundGrid(const CampusSite& site) : xs_(site.plan().gridX()), ys_(site.plan().gridY()) {
    corners_.reserve(xs_.size() * ys_.size());
    for (std::size_t j = 0; j < ys_.size(); ++j)
      for (std::size_t i = 0; i < xs_.size(); ++i) {
        Vector3d corner = site.onGround({xs_[i], ys_[j]});
        const bool grass = site.plan().kindAt(xs_[i], ys_[j]) == SurfaceLabel::Lawn;
        if (grass) corner.z() += site.stream(RandomUse::Ground, corners_.size()).uniform(-0.02, 0.03);
        corners_.push_back(corner);
      }
  }
  std::size_t columns() const { return xs_.size() - 1; }
  std::size_t rows() const { return ys_.size() - 1; }
  const Vector3d& corner(std::size_t i, std::size_t j) const { return corners_[j * xs_.size() + i]; }

 private:
  std::vector<double> xs_, ys_;
  std::vector<Vector3d> corners_;
};

}  // namespace

void makeGround(CampusSite& site) {
  const std::int32_t ground = site.addObject(ObjectClass::Ground, "ground", site.onGround({0, 0}), 0);
  const GroundGrid grid(site);
  std::map<SurfaceLabel, CampusMesh> surfaces;
  for (std::size_t j = 0; j < grid.rows(); ++j)
    for (std::size_t i = 0; i < grid.columns(); ++i) {
      const Corners corners{grid.corner(i, j), grid.corner(i + 1, j), grid.corner(i + 1, j + 1), grid.corner(i, j + 1)};
      const Vector3d middle = 0.5 * (corners[0] + corners[2]);
      const SurfaceLabel kind = site.plan().kindAt(middle.x(), middle.y());
      addQuad(surfaces.try_emplace(kind, surfaceOf(kind, ground, lookOf(kind))).first->second, corners);
    }
  for (auto& [kind, surface] : surfaces) site.addSurface(std::move(surface));
}

}  // namespace cluxel::simulation
