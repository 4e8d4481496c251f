// SPDX-License-Identifier: Apache-2.0
// Merging by sums, minima, maxima and hulls; then the attributes that rules read.
#include "perception/segments/merged_component.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/convex_hull.hpp"
#include "base/steady_angle.hpp"

namespace cluxel::perception {

namespace {

/// A footprint cell touches the ground if its lowest point is less than this above it [m].
constexpr float kGroundContact_m = 0.30F;

Eigen::Vector3d vectorOf(const std::array<float, 3>& values) {
  return Eigen::Vector3d(values[0], values[1], values[2]);
}

Eigen::Vector3d upward(const Eigen::Vector3d& axis) {
  return axis.z() < 0 ? Eigen::Vector3d(-axis) : axis;
}

double& attributeIn(Primitive& primitive, Attribute attribute) {
  return primitive.attributes[static_cast<std::size_t>(attribute)];
}

}  // namespace

void MergedComponent::addMoments(const Component& component, const Eigen::Vector3d& corner) {
  const Eigen::Vector3d mean = corner + Eigen::Vector3d(component.mean[0], component.mean[1], component.mean[2]);
  const double added = component.points, total = points_ + added;
  const Eigen::Vector3d d = mean - mean_;
  const double weight = points_ * added / total;
  const std::array<double, 6> products{d.x() * d.x(), d.x() * d.y(), d.x() * d.z(),
                                       d.y() * d.y(), d.y() * d.z(), d.z() * d.z()};
  for (std::size_t i = 0; i < 6; ++i) scatter_[i] += component.scatter[i] + weight * products[i];
  mean_ += d * (added / total);
  points_ = total;
}

void MergedComponent::add(const ComponentTile& tile, std::size_t number, const Eigen::Vector3d& corner_map) {
  const Component& component = tile.components[number];
  addMoments(component, corner_map);
  cluxels_ += component.cluxels;
  intensity_ += component.intensity;
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) probability_[k] += component.probability[k];
  min_ = min_.cwiseMin(corner_map + vectorOf(component.min));
  max_ = max_.cwiseMax(corner_map + vectorOf(component.max));
  lowest_ = std::min<double>(lowest_, component.lowest);
  highest_ = std::max<double>(highest_, component.highest);
  for (const FootprintCell& cell : tile.cellsOf(number)) {
    cells_.push_back({cell.lowest, cell.count});
    ground_z_sum_ += corner_map.z() + static_cast<double>(cell.min[2]) - static_cast<double>(cell.lowest);
  }
  for (std::uint32_t i = tile.hull_offset[number]; i < tile.hull_offset[number + 1]; ++i)
    hull_.emplace_back(corner_map.head<2>() + tile.hull[i].cast<double>());
  scans_.insert(tile.scans.begin() + tile.scan_offset[number], tile.scans.begin() + tile.scan_offset[number + 1]);
}

void MergedComponent::describeShape(Primitive& primitive) const {
  Eigen::Matrix3d covariance;
  covariance << scatter_[0], scatter_[1], scatter_[2], scatter_[1], scatter_[3], scatter_[4], scatter_[2], scatter_[4],
      scatter_[5];
  covariance /= std::max(points_, 1.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d l = solver.eigenvalues().cwiseMax(0.0);  // ascending
  constexpr double kPoint_m2 = 1e-10;
  if (l[2] < kPoint_m2) return;
  primitive.axis = upward(solver.eigenvectors().col(2));
  primitive.normal = upward(solver.eigenvectors().col(0));
  attributeIn(primitive, Attribute::Linearity) = (l[2] - l[1]) / l[2];
  attributeIn(primitive, Attribute::Planarity) = (l[1] - l[0]) / l[2];
  attributeIn(primitive, Attribute::Scattering) = l[0] / l[2];
  attributeIn(primitive, Attribute::Radius) = std::sqrt(l[0] + l[1]);
  attributeIn(primitive, Attribute::Roughness) = std::sqrt(l[0]);
}

void MergedComponent::describeHeights(Primitive& primitive) const {
  std::vector<float> lowest;
  std::size_t touching = 0;
  for (const CellHeight& cell : cells_) {
    lowest.push_back(cell.lowest);
    touching += cell.lowest <= kGroundContact_m ? 1 : 0;
  }
  const auto median = lowest.begin() + static_cast<std::ptrdiff_t>(lowest.size() / 2);
  std::nth_element(lowest.begin(), median, lowest.end());
  const auto count = static_cast<double>(cells_.size());
  attributeIn(primitive, Attribute::FreeHeightBelow) = *median;
  attributeIn(primitive, Attribute::GroundContact) = static_cast<double>(touching) / count;
  attributeIn(primitive, Attribute::FootprintArea) = count * kFootprintCell_m * kFootprintCell_m;
  primitive.ground_z = ground_z_sum_ / count;
}

void MergedComponent::describe(Primitive& primitive) const {
  const FootprintBox box = smallestBox(convexHull(hull_));
  const double height = max_.z() - min_.z();
  primitive.box.center << box.center, 0.5 * (min_.z() + max_.z());
  primitive.box.size << box.length_m, box.width_m, height;
  primitive.box.yaw_rad = box.yaw_rad;
  primitive.min = min_, primitive.max = max_, primitive.centroid = mean_;
  describeShape(primitive);
  describeHeights(primitive);
  const auto set = [&](Attribute attribute, double value) { attributeIn(primitive, attribute) = value; };
  set(Attribute::Height, height);
  set(Attribute::HorizontalExtent, box.length_m), set(Attribute::Length, box.length_m);
  set(Attribute::HorizontalThickness, box.width_m), set(Attribute::Width, box.width_m);
  set(Attribute::Volume, box.length_m * box.width_m * height);
  set(Attribute::Bottom, lowest_), set(Attribute::Top, highest_);
  set(Attribute::ElevationSpan, highest_ - lowest_);
  set(Attribute::NormalTilt, steadyAcos(primitive.normal.z()));
  set(Attribute::AxisTilt, steadyAcos(primitive.axis.z()));
  set(Attribute::PointCount, points_), set(Attribute::CluxelCount, cluxels_);
  set(Attribute::ViewCount, static_cast<double>(scans_.size()));
  set(Attribute::MeanIntensity, intensity_ / points_);
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
    primitive.probabilities[k] = static_cast<float>(probability_[k] / points_);
  set(Attribute::Probability, primitive.probabilities[static_cast<std::size_t>(primitive.label)]);
}

}  // namespace cluxel::perception
