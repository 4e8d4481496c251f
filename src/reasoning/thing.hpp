// SPDX-License-Identifier: Apache-2.0
// Things: what rules bind to names. One piece of a primitive or several together, measured as one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cluxel/perception/scene.hpp"

namespace cluxel {

using PieceIndex = std::uint32_t;

/// What is measured of a set of cluxels.
struct Shape {
  std::array<double, kAttributeCount> attributes{};
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();        ///< [m, map]
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();                                  ///< [m, map]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ(), normal = Eigen::Vector3d::UnitZ();  ///< both with z >= 0
  double points = 0;

  double operator[](Attribute attribute) const { return attributes[static_cast<std::size_t>(attribute)]; }
};

struct Thing {
  std::vector<PieceIndex> pieces;  ///< ascending
  Shape shape;
};

/// The shape of a whole primitive, as perception measured it.
Shape shapeOfPrimitive(const Primitive& primitive, const SceneCluxels& cluxels);

/// The shape of any cluxels, from their means, boxes and numbers of points. `members` are the primitives they come
/// from; they give what cluxels do not know (views, intensity, ground contact). Moments are merged: of the primitives
/// that are `whole` among the cluxels their own, so that a group of one is measured like the one; of the other cluxels
/// as if their points were spread evenly over their boxes. Cost O(n log n).
Shape shapeOfCluxels(const Scene& scene, std::span<const std::uint32_t> cluxels,
                     std::span<const PrimitiveIndex> members, std::span<const PrimitiveIndex> whole);

}  // namespace cluxel
