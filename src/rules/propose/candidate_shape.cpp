// SPDX-License-Identifier: Apache-2.0
// Measures sets of cluxels: moments, heights above ground, footprint.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/steady_angle.hpp"
#include "perception/segments/component_tile.hpp"
#include "rules/propose/outline.hpp"

namespace cluxel::rules {

namespace {

using Point2 = Eigen::Vector2d;

/// The cells of the footprint that a cluxel's box covers: columns and rows, ends included.
struct CellRange {
  std::int64_t first_x = 0, first_y = 0, last_x = 0, last_y = 0;
};

CellRange cellsOf(const perception::SceneCluxels& all, std::uint32_t cluxel) {
  const Point2 center = (all.center[cluxel] - all.grid.corner()).head<2>();
  const Point2 half = all.extent[cluxel].head<2>().cast<double>() / 2;
  const Point2 low = (center - half) / perception::kFootprintCell_m;
  const Point2 high = (center + half) / perception::kFootprintCell_m;
  CellRange range{static_cast<std::int64_t>(std::floor(low.x())), static_cast<std::int64_t>(std::floor(low.y()))};
  // A cluxel is at most one ball wide, so that these ranges are short; the bound of 40 guards against broken input.
  range.last_x = std::min(range.first_x + 40, static_cast<std::int64_t>(std::floor(high.x())));
  range.last_y = std::min(range.first_y + 40, static_cast<std::int64_t>(std::floor(high.y())));
  return range;
}

/// How many different cells the ranges cover: by a bitmap, or by sorting where the set is wide and thin.
std::size_t countCells(const std::vector<CellRange>& ranges) {
  CellRange all = ranges.front();
  for (const CellRange& range : ranges) {
    all.first_x = std::min(all.first_x, range.first_x), all.first_y = std::min(all.first_y, range.first_y);
    all.last_x = std::max(all.last_x, range.last_x), all.last_y = std::max(all.last_y, range.last_y);
  }
  const auto columns = static_cast<std::size_t>(all.last_x - all.first_x + 1);
  const auto rows = static_cast<std::size_t>(all.last_y - all.first_y + 1);
  constexpr std::size_t kMaxCellsOfRange = 1000;
  if (columns / kMaxCellsOfRange > ranges.size() || rows > kMaxCellsOfRange * ranges.size() / columns) {
    std::vector<std::pair<std::int64_t, std::int64_t>> cells;
    for (const CellRange& range : ranges)
      for (std::int64_t x = range.first_x; x <= range.last_x; ++x)
        for (std::int64_t y = range.first_y; y <= range.last_y; ++y) cells.emplace_back(x, y);
    std::sort(cells.begin(), cells.end());
    return static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
  }
  std::vector<bool> covered(columns * rows, false);
  std::size_t count = 0;
  for (const CellRange& range : ranges)
    for (std::int64_t x = range.first_x; x <= range.last_x; ++x)
      for (std::int64_t y = range.first_y; y <= range.last_y; ++y) {
        auto cell =
            covered[static_cast<std::size_t>(x - all.first_x) * rows + static_cast<std::size_t>(y - all.first_y)];
        count += cell ? 0 : 1;
        cell = true;
      }
  return count;
}

double footprintArea(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels) {
  std::vector<CellRange> ranges;
  ranges.reserve(cluxels.size());
  for (const std::uint32_t i : cluxels) ranges.push_back(cellsOf(all, i));
  return static_cast<double>(countCells(ranges)) * perception::kFootprintCell_m * perception::kFootprintCell_m;
}

/// The value below which half of the weight lies. Weights are whole numbers, so that their sums are exact. Expected
/// cost O(n).
double weightedMedian(std::vector<std::pair<double, double>> values) {
  if (values.empty()) return 0;
  double total = 0, below = 0;
  for (const auto& [value, weight] : values) total += weight;
  auto first = values.begin(), last = values.end();
  while (last - first > 1) {
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last);
    double left = 0;
    for (auto at = first; at != middle; ++at) left += at->second;
    if (below + left >= total / 2) {
      last = middle;
    } else {
      below += left;
      first = middle;
    }
  }
  return first->first;
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
            std::span<const perception::PrimitiveIndex> whole, const Outline& outline)
      : scene_(scene), all_(scene.cluxels), cluxels_(cluxels), whole_(whole), outline_(outline) {}

  Shape measure() {
    if (cluxels_.empty()) return shape_;
    setAttributes(outline_, shape_);
    means();
    at(perception::Attribute::FootprintArea) = footprintArea(all_, cluxels_);
    at(perception::Attribute::FreeHeightBelow) = medianHeight();
    moments();
    return shape_;
  }

 private:
  double& at(perception::Attribute attribute) { return shape_.attributes[static_cast<std::size_t>(attribute)]; }
  double weight(std::uint32_t cluxel) const { return std::max<double>(1, all_.point_count[cluxel]); }

  void means() {
    for (std::uint32_t i : cluxels_) {
      shape_.centroid += weight(i) * all_.center[i];
      shape_.points += weight(i);
      const auto label = static_cast<std::size_t>(all_.label[i]);
      at(perception::Attribute::Probability) += weight(i) * static_cast<double>(all_.probability[i][label]);
    }
    shape_.centroid /= shape_.points;
    at(perception::Attribute::Probability) /= shape_.points;
    at(perception::Attribute::PointCount) = shape_.points;
  }

  double medianHeight() const {
    std::vector<std::pair<double, double>> above;
    above.reserve(cluxels_.size());
    for (std::uint32_t i : cluxels_) above.emplace_back(all_.height_above_ground[i], weight(i));
    return weightedMedian(std::move(above));
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
  const Outline& outline_;
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
                     std::span<const perception::PrimitiveIndex> whole, const Outline& outline) {
  Shape shape = Measuring(scene, cluxels, whole, outline).measure();
  takeFromMembers(scene, members, shape);
  return shape;
}

Shape shapeOfCluxels(const perception::Scene& scene, std::span<const std::uint32_t> cluxels,
                     std::span<const perception::PrimitiveIndex> members,
                     std::span<const perception::PrimitiveIndex> whole) {
  return shapeOfCluxels(scene, cluxels, members, whole, outlineOf(scene.cluxels, cluxels));
}

}  // namespace cluxel::rules
