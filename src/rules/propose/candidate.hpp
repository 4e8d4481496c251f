// SPDX-License-Identifier: Apache-2.0
// Candidates: what rules bind to names. A candidate is one fragment of a primitive, or several that are measured
// together.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

using FragmentIndex = std::uint32_t;

/// Measured attributes and extent of a set of cluxels.
struct Shape {
  std::array<double, perception::kAttributeCount> attributes{};
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();        ///< [m, map]
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();                                  ///< [m, map]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ(), normal = Eigen::Vector3d::UnitZ();  ///< both with z >= 0
  double points = 0;

  double operator[](perception::Attribute attribute) const { return attributes[static_cast<std::size_t>(attribute)]; }
};

struct Outline;

struct Candidate {
  std::vector<FragmentIndex> fragments;  ///< ascending
  Shape shape;
};

/// The shape of a whole primitive, taken from perception's measurements.
Shape shapeOfPrimitive(const perception::Primitive& primitive, const perception::SceneCluxels& cluxels);

/// The shape of any set of cluxels, computed from their means, boxes and point counts. `members` are the primitives
/// they come from; views, intensity and ground contact are taken from these. Moments are merged: primitives in `whole`
/// contribute their own moments, so that a group of one gets the same shape as its primitive; other cluxels contribute
/// as if their points were spread evenly over their boxes. Cost O(n log n).
Shape shapeOfCluxels(const perception::Scene& scene, std::span<const std::uint32_t> cluxels,
                     std::span<const perception::PrimitiveIndex> members,
                     std::span<const perception::PrimitiveIndex> whole);
/// The same when the outline of `cluxels` is known.
Shape shapeOfCluxels(const perception::Scene& scene, std::span<const std::uint32_t> cluxels,
                     std::span<const perception::PrimitiveIndex> members,
                     std::span<const perception::PrimitiveIndex> whole, const Outline& outline);

}  // namespace cluxel::rules
