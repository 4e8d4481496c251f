// SPDX-License-Identifier: Apache-2.0
// What can be merged of the shapes of two sets of cluxels: bounds, heights above the ground and the hull from above.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/propose/candidate.hpp"

namespace cluxel::rules {

/// Covers the boxes of a set of cluxels.
struct Outline {
  std::vector<Eigen::Vector2d> hull;  ///< as convexHull() gives it [m, map]
  Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());  ///< [m, map]
  double bottom = std::numeric_limits<double>::infinity(), top = -bottom;  ///< above the local ground [m]
  double cluxels = 0;
};

/// Cost O(n log n).
Outline outlineOf(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels);
/// The outline of the union of disjoint sets. Cost O(n log n) in the corners of their hulls.
Outline unionOf(std::span<const Outline* const> outlines);

/// Whether setAttributes() sets the attribute.
bool isOfOutline(perception::Attribute attribute);
/// Sets the bounds of a shape and the attributes that follow from the outline.
void setAttributes(const Outline& outline, Shape& shape);

}  // namespace cluxel::rules
