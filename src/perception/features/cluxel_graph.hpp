// SPDX-License-Identifier: Apache-2.0
// The cluxels that the features of one tile read, and the graph of intersecting cluxels.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "perception/clustering/cluxel_tile.hpp"

namespace cluxel::perception {

/// A cluxel's bounding volume relative to the centre tile's corner [m].
struct Volume {
  Eigen::Vector3f low, high;
  /// It was not measured, and meets nothing.
  bool isEmpty() const { return !(low.x() <= high.x()); }
};

inline bool intersects(const Volume& a, const Volume& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

/// What supports read of a cluxel, in one cache line: its centre and the covariance of its own points.
struct Member {
  Eigen::Array4f place;       ///< its centre: x y z, and 0 [m]
  Eigen::Array4f yzx;         ///< y z x, and 0
  Eigen::Array4f spread;      ///< mean squares of deviations xx yy zz [m2], and the lowest z of its box [m, map]
  Eigen::Array4f spread_yzx;  ///< mean products xy yz zx [m2], and the highest z of its box [m, map]
  float lowZ() const { return spread[3]; }
  float highZ() const { return spread_yzx[3]; }
};

/// Own cluxels, those whose volume may intersect an own one's ("near"), and those that may intersect a near one's;
/// sorted by ring tile and number. Positions are relative to the centre tile's corner.
struct RingCluxels {
  std::vector<RingIndex> name;
  std::vector<Eigen::Vector3f> center;
  std::vector<Volume> volume;
  std::vector<Member> member;
  std::vector<float> reach;
  std::vector<std::uint8_t> near;  ///< 1 for own and near cluxels: their edges are complete
  std::uint32_t own_begin = 0, own_end = 0;

  std::size_t size() const { return name.size(); }
};
RingCluxels gatherCluxels(const Ring<CluxelTile>& ring);

/// Edges of own and near cluxels, in CSR form with ascending targets; the others have none.
struct RingGraph {
  std::vector<std::uint32_t> offset, target;
  std::span<const std::uint32_t> neighbours(std::uint32_t cluxel) const {
    return {target.data() + offset[cluxel], target.data() + offset[cluxel + 1]};
  }
};
RingGraph intersectionGraph(const RingCluxels& cluxels);

}  // namespace cluxel::perception
