// SPDX-License-Identifier: Apache-2.0
// Measures sets of cluxels: moments, the smallest upright box, heights above ground, footprint.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/convex_hull.hpp"
#include "base/steady_angle.hpp"
#include "perception/segments/component_tile.hpp"
#include "rules/propose/candidate.hpp"

namespace cluxel::rules {

namespace {

using Point2 = Eigen::Vector2d;

std::vector<Point2> footprintCorners(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels) {
  std::vector<Point2> corners;
  corners.reserve(4 * cluxels.size());
  for (std::uint32_t i : cluxels) {
    const Point2 centre = all.center[i].head<2>();
    const Point2 half = all.extent[i].head<2>().cast<double>() / 2;
    for (double sx : {-1.0, 1.0})
      for (double sy : {-1.0, 1.0}) corners.emplace_back(centre.x() + sx * half.x(), centre.y() + sy * half.y());
  }
  return corners;
}

double footprintArea(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels) {
  std::vector<std::pair<std::int64_t, std::int64_t>> cells;
  for (std::uint32_t i : cluxels) {
    const Point2 half = all.extent[i].head<2>().cast<double>() / 2;
    const Point2 low = (all.center[i].head<2>() - half) / perception::kFootprintCell_m;
    const Point2 high = (all.center[i].head<2>() + half) / perception::kFootprintCell_m;
    // A cluxel is at most one ball wide, so that these ranges are short; the bound of 40 guards against broken input.
    const auto first_x = static_cast<std::int64_t>(std::floor(low.x()));
    const auto first_y = static_cast<std::int64_t>(std::floor(low.y()));
    const auto last_x = std::min(first_x + 40, static_cast<std::int64_t>(std::floor(high.x())));
    const auto last_y = std::min(first_y + 40, static_cast<std::int64_t>(std::floor(high.y())));
    for (std::int64_t x = first_x; x <= last_x; ++x)
      for (std::int64_t y = first_y; y <= last_y; ++y) cells.emplace_back(x, y);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return static_cast<double>(cells.size()) * perception::kFootprintCell_m * perception::kFootprintCell_m;
}

/// The value below which half of the weight lies.
double weightedMedian(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0, sum = 0;
  for (const auto& [value, weight] : values) total += weight;
  for (const auto& [value, weight] : values)
    if ((sum += weight) >= total / 2) return value;
  return values.empty() ? 0 : values.back().first;
}

/// Points as their number, mean and covariance.
struct Moments {
  double weight = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// The covariance of a primitive's points, reconstructed from its attributes. Absent when an extent is zero, because
/// the attributes then do not determine the eigenvalues.
std::optional<Eigen::Matrix3d> covarianceOf(const perception::Primitive& primitive) {
  const double l0 = primitive[perception::Attribute::Roughness] * primitive[perception::Attribute::Roughness];
  const double l1 = primitive[perception::Attribute::Radius] * primitive[perception::Attribute::Radius] - l0;
  const double rest = 1 - primitive[perception::Attribute::Linearity];
  if (l1 <= 0 || rest <= 1e-6) return std::nullopt;
  const Eigen::Vector3d& axis = primitive.axis;
  const Eigen::Vector3d& normal = primitive.normal;
  const Eigen::Vector3d across = axis.cross(normal);
  if (std::abs(axis.dot(normal)) > 1e-3) return std::nullopt;
  return Eigen::Matrix3d(l1 / rest * axis * axis.transpose() + l1 * across * across.transpose() +
                         l0 * normal * normal.transpose());
}

class Measuring {
 public:
  /// `whole` are the primitives all of whose cluxels are among `cluxels`.
  Measuring(const perception::Scene& scene, std::span<const std::uint32_t> cluxels,
            std::span<const perception::PrimitiveIndex> whole)
      : scene_(scene), all_(scene.cluxels), cluxels_(cluxels), whole_(whole) {}

  Shape measure() {
    if (cluxels_.empty()) return shape_;
    boundsAndMean();
    upright();
    heights();
    moments();
    return shape_;
  }

 private:
  double& at(perception::Attribute attribute) { return shape_.attributes[static_cast<std::size_t>(attribute)]; }
  double weight(std::uint32_t cluxel) const { return std::max<double>(1, all_.point_count[cluxel]); }

  void boundsAndMean() {
    shape_.min = Eigen::Vector3d::Constant(1e300);
    shape_.max = -shape_.min;
    for (std::uint32_t i : cluxels_) {
      const Eigen::Vector3d half = all_.extent[i].cast<double>() / 2;
      shape_.min = shape_.min.cwiseMin(all_.center[i] - half);
      shape_.max = shape_.max.cwiseMax(all_.center[i] + half);
      shape_.centroid += weight(i) * all_.center[i];
      shape_.points += weight(i);
      const auto label = static_cast<std::size_t>(all_.label[i]);
      at(perception::Attribute::Probability) += weight(i) * static_cast<double>(all_.probability[i][label]);
    }
    shape_.centroid /= shape_.points;
    at(perception::Attribute::Probability) /= shape_.points;
    at(perception::Attribute::PointCount) = shape_.points;
    at(perception::Attribute::CluxelCount) = static_cast<double>(cluxels_.size());
  }

  void upright() {
    const FootprintBox box = smallestBox(convexHull(footprintCorners(all_, cluxels_)));
    const double length = box.length_m, width = box.width_m;
    at(perception::Attribute::HorizontalExtent) = at(perception::Attribute::Length) = length;
    at(perception::Attribute::HorizontalThickness) = at(perception::Attribute::Width) = width;
    at(perception::Attribute::Height) = shape_.max.z() - shape_.min.z();
    at(perception::Attribute::Volume) = length * width * at(perception::Attribute::Height);
    at(perception::Attribute::FootprintArea) = footprintArea(all_, cluxels_);
  }

  void heights() {
    double bottom = 1e300, top = -1e300;
    std::vector<std::pair<double, double>> above;
    for (std::uint32_t i : cluxels_) {
      const double height = static_cast<double>(all_.height_above_ground[i]);
      const double half = static_cast<double>(all_.extent[i].z()) / 2;
      bottom = std::min(bottom, height - half);
      top = std::max(top, height + half);
      above.emplace_back(height, weight(i));
    }
    at(perception::Attribute::Bottom) = bottom;
    at(perception::Attribute::Top) = top;
    at(perception::Attribute::ElevationSpan) = top - bottom;
    at(perception::Attribute::FreeHeightBelow) = weightedMedian(std::move(above));
  }

  /// Whole primitives with their own moments; other cluxels with those of a uniformly filled box.
  std::vector<Moments> blocks() const {
    std::vector<Moments> blocks;
    std::vector<perception::PrimitiveIndex> done;
    for (perception::PrimitiveIndex index : whole_) {
      const perception::Primitive& primitive = scene_.primitives[index];
      const auto covariance = covarianceOf(primitive);
      if (!covariance) continue;
      Moments block{0, primitive.centroid, *covariance};
      for (std::uint32_t i : primitive.cluxels) block.weight += weight(i);
      blocks.push_back(block);
      done.push_back(index);
    }
    std::sort(done.begin(), done.end());
    for (std::uint32_t i : cluxels_) {
      if (std::binary_search(done.begin(), done.end(), all_.primitive[i])) continue;
      const Eigen::Vector3d spread = all_.extent[i].cast<double>().cwiseAbs2() / 12;
      blocks.push_back({weight(i), all_.center[i], spread.asDiagonal()});
    }
    return blocks;
  }

  void moments() {
    const std::vector<Moments> parts = blocks();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Moments& part : parts) mean += part.weight / shape_.points * part.mean;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Moments& part : parts) {
      const Eigen::Vector3d d = part.mean - mean;
      covariance += part.weight / shape_.points * (d * d.transpose() + part.covariance);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const Eigen::Vector3d l = solver.eigenvalues().cwiseMax(0);
    const double l1 = l[2] > 0 ? l[2] : 1;
    shape_.axis = upward(solver.eigenvectors().col(2));
    shape_.normal = upward(solver.eigenvectors().col(0));
    at(perception::Attribute::Linearity) = (l[2] - l[1]) / l1;
    at(perception::Attribute::Planarity) = (l[1] - l[0]) / l1;
    at(perception::Attribute::Scattering) = l[0] / l1;
    at(perception::Attribute::Roughness) = std::sqrt(l[0]);
    at(perception::Attribute::Radius) = std::sqrt(l[0] + l[1]);
    at(perception::Attribute::AxisTilt) = steadyAcos(shape_.axis.z());
    at(perception::Attribute::NormalTilt) = steadyAcos(shape_.normal.z());
  }

  static Eigen::Vector3d upward(const Eigen::Vector3d& v) { return v.z() < 0 ? Eigen::Vector3d(-v) : v; }

  const perception::Scene& scene_;
  const perception::SceneCluxels& all_;
  std::span<const std::uint32_t> cluxels_;
  std::span<const perception::PrimitiveIndex> whole_;
  Shape shape_;
};

/// Attributes that cannot be computed from cluxels: intensity, view count, ground contact.
void takeFromMembers(const perception::Scene& scene, std::span<const perception::PrimitiveIndex> members,
                     Shape& shape) {
  auto at = [&](perception::Attribute attribute) -> double& {
    return shape.attributes[static_cast<std::size_t>(attribute)];
  };
  double points = 0;
  const perception::Primitive* lowest = nullptr;
  for (perception::PrimitiveIndex index : members) {
    const perception::Primitive& member = scene.primitives[index];
    const double weight = std::max(1.0, member[perception::Attribute::PointCount]);
    points += weight;
    at(perception::Attribute::MeanIntensity) += weight * member[perception::Attribute::MeanIntensity];
    at(perception::Attribute::ViewCount) =
        std::max(at(perception::Attribute::ViewCount), member[perception::Attribute::ViewCount]);
    const bool lower =
        lowest == nullptr || member[perception::Attribute::Bottom] < (*lowest)[perception::Attribute::Bottom] ||
        (member[perception::Attribute::Bottom] == (*lowest)[perception::Attribute::Bottom] && member.id < lowest->id);
    if (lower) lowest = &member;
  }
  if (lowest == nullptr) return;
  at(perception::Attribute::MeanIntensity) /= points;
  at(perception::Attribute::GroundContact) = (*lowest)[perception::Attribute::GroundContact];
}

}  // namespace

Shape shapeOfPrimitive(const perception::Primitive& primitive, const perception::SceneCluxels& cluxels) {
  Shape shape;
  shape.attributes = primitive.attributes;
  shape.min = primitive.min;
  shape.max = primitive.max;
  shape.centroid = primitive.centroid;
  shape.axis = primitive.axis;
  shape.normal = primitive.normal;
  for (std::uint32_t i : primitive.cluxels) shape.points += std::max<double>(1, cluxels.point_count[i]);
  return shape;
}

Shape shapeOfCluxels(const perception::Scene& scene, std::span<const std::uint32_t> cluxels,
                     std::span<const perception::PrimitiveIndex> members,
                     std::span<const perception::PrimitiveIndex> whole) {
  Shape shape = Measuring(scene, cluxels, whole).measure();
  takeFromMembers(scene, members, shape);
  return shape;
}

}  // namespace cluxel::rules
