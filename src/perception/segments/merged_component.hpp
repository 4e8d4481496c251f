// SPDX-License-Identifier: Apache-2.0
// The partial results of one primitive's components, merged over tiles in the map frame.
#pragma once

#include <Eigen/Core>
#include <array>
#include <set>
#include <vector>

#include "perception/segments/component_tile.hpp"
#include "perception/segments/primitive.hpp"

namespace cluxel::perception {

class MergedComponent {
 public:
  /// Adds component `number` of `tile`, whose corner is at `corner_map`. Call in canonical order, which fixes the
  /// rounding of sums.
  void add(const ComponentTile& tile, std::size_t number, const Eigen::Vector3d& corner_map);
  /// Fills the attributes, boxes, axes and probabilities of `primitive`.
  void describe(Primitive& primitive) const;
  /// The scans with a point in it.
  const std::set<scan::ScanId>& scans() const { return scans_; }

 private:
  struct CellHeight {
    float lowest = 0;         ///< above the local ground [m]
    std::uint32_t count = 0;  ///< points
  };
  void addMoments(const Component& component, const Eigen::Vector3d& corner);
  void describeShape(Primitive& primitive) const;
  void describeHeights(Primitive& primitive) const;

  double points_ = 0, cluxels_ = 0, intensity_ = 0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  std::array<double, 6> scatter_{};
  std::array<double, scan::kPrimitiveLabelCount> probability_{};
  Eigen::Vector3d min_ = Eigen::Vector3d::Constant(1e300), max_ = Eigen::Vector3d::Constant(-1e300);
  double lowest_ = 1e300, highest_ = -1e300;
  double ground_z_sum_ = 0;
  std::vector<CellHeight> cells_;
  std::vector<Eigen::Vector2d> hull_;
  std::set<scan::ScanId> scans_;
};

}  // namespace cluxel::perception
