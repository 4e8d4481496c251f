// SPDX-License-Identifier: Apache-2.0
// A plane in metres for each coordinate system, in which searches compare boxes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/proj_reference_system.hpp"
#include "sparql/geometry/geometry.hpp"

namespace cluxel::sparql {

/// Boxes of geometries of one system. Boxes are never farther apart than what geof:distance says of the geometries, and
/// boxes of geometries that intersect meet. Geographic coordinates are projected at right angles on the plane that
/// touches the ellipsoid at the first of them: chords are shorter than ways along the ellipsoid, and their projections
/// are shorter still.
class SearchFrame {
 public:
  explicit SearchFrame(const ReferenceSystem& system) : system_(system) {}
  /// Absent for empty and very long geometries, for those far from the first one, and in systems of unknown kind.
  std::optional<Box2> boxOf(const Geometry& geometry);

 private:
  using Vector = std::array<double, 3>;
  std::optional<Box2> boxOnEarth(const Geometry& geometry);
  std::optional<Vector> placed(double first, double second);

  ReferenceSystem system_;
  bool has_origin_ = false;
  Vector east_{}, north_{}, up_{};
};

}  // namespace cluxel::sparql
