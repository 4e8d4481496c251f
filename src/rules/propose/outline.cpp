// SPDX-License-Identifier: Apache-2.0
// The hull of a union is the hull of the corners of both hulls, so that large sets are not measured again.
#include "rules/propose/outline.hpp"

#include <algorithm>
#include <array>

#include "base/convex_hull.hpp"

namespace cluxel::rules {

namespace {

using perception::Attribute;

std::vector<Eigen::Vector2d> cornersOf(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels) {
  std::vector<Eigen::Vector2d> corners;
  corners.reserve(4 * cluxels.size());
  for (const std::uint32_t i : cluxels) {
    const Eigen::Vector2d centre = all.center[i].head<2>(), half = all.extent[i].head<2>().cast<double>() / 2;
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0}) corners.emplace_back(centre.x() + sx * half.x(), centre.y() + sy * half.y());
  }
  return corners;
}

}  // namespace

Outline outlineOf(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels) {
  Outline outline;
  outline.cluxels = static_cast<double>(cluxels.size());
  for (const std::uint32_t i : cluxels) {
    const Eigen::Vector3d half = all.extent[i].cast<double>() / 2;
    outline.min = outline.min.cwiseMin(all.center[i] - half);
    outline.max = outline.max.cwiseMax(all.center[i] + half);
    const auto height = static_cast<double>(all.height_above_ground[i]);
    outline.bottom = std::min(outline.bottom, height - half.z());
    outline.top = std::max(outline.top, height + half.z());
  }
  outline.hull = convexHull(cornersOf(all, cluxels));
  return outline;
}

Outline unionOf(std::span<const Outline* const> outlines) {
  Outline all;
  std::vector<Eigen::Vector2d> corners;
  for (const Outline* outline : outlines) {
    all.cluxels += outline->cluxels;
    all.min = all.min.cwiseMin(outline->min);
    all.max = all.max.cwiseMax(outline->max);
    all.bottom = std::min(all.bottom, outline->bottom);
    all.top = std::max(all.top, outline->top);
    corners.insert(corners.end(), outline->hull.begin(), outline->hull.end());
  }
  all.hull = convexHull(std::move(corners));
  return all;
}

bool isOfOutline(Attribute attribute) {
  static constexpr std::array kSet{Attribute::HorizontalExtent,
                                   Attribute::Length,
                                   Attribute::HorizontalThickness,
                                   Attribute::Width,
                                   Attribute::Height,
                                   Attribute::Volume,
                                   Attribute::Bottom,
                                   Attribute::Top,
                                   Attribute::ElevationSpan,
                                   Attribute::CluxelCount};
  return std::find(kSet.begin(), kSet.end(), attribute) != kSet.end();
}

void setAttributes(const Outline& outline, Shape& shape) {
  const auto at = [&](Attribute attribute) -> double& { return shape.attributes[static_cast<std::size_t>(attribute)]; };
  const FootprintBox box = smallestBox(outline.hull);
  shape.min = outline.min;
  shape.max = outline.max;
  at(Attribute::HorizontalExtent) = at(Attribute::Length) = box.length_m;
  at(Attribute::HorizontalThickness) = at(Attribute::Width) = box.width_m;
  at(Attribute::Height) = outline.max.z() - outline.min.z();
  at(Attribute::Volume) = box.length_m * box.width_m * at(Attribute::Height);
  at(Attribute::Bottom) = outline.bottom;
  at(Attribute::Top) = outline.top;
  at(Attribute::ElevationSpan) = outline.top - outline.bottom;
  at(Attribute::CluxelCount) = outline.cluxels;
}

}  // namespace cluxel::rules
