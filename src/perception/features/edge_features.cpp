// SPDX-License-Identifier: Apache-2.0
// Edge features: how alike two intersecting cluxels are. Positions are exact floats and every formula is symmetric, so
// both tiles at a border compute the same numbers.
#include <algorithm>
#include <array>
#include <cmath>

#include "perception/features/feature_groups.hpp"

namespace cluxel::perception {
namespace {

/// Volumes are padded by this before their overlap is measured, since flat and single-point volumes have no volume [m].
constexpr float kMinThickness_m = 0.02F;
constexpr std::size_t kEdgeColumns = 10;

Eigen::Vector3f widened(const Eigen::Vector3f& size) {
  return size.array() + kMinThickness_m;
}

/// What edge features read of a cluxel, packed together since the ends of edges are accessed at random.
struct EdgeEnd {
  Eigen::Vector3f center;
  float reach;
  Volume volume;
  float size;  ///< of the padded volume [m3]
  Eigen::Vector3f normal;
  double linearity, planarity, scattering;
};

EdgeEnd edgeEnd(const RingCluxels& cluxels, std::size_t c, const EigenShape& ball) {
  const Volume& volume = cluxels.volume[c];
  return {cluxels.center[c],         cluxels.reach[c], volume,           widened(volume.high - volume.low).prod(),
          ball.normal.cast<float>(),  // lossless: computed in float
          ball.linearity(),          ball.planarity(), ball.scattering()};
}

/// Common volume over the smaller volume, in [0, 1].
float volumeShare(const EdgeEnd& a, const EdgeEnd& b) {
  const Eigen::Vector3f common = widened(a.volume.high.cwiseMin(b.volume.high) - a.volume.low.cwiseMax(b.volume.low));
  return common.prod() / std::min(a.size, b.size);
}

/// Marks the members of one cluxel's 1-ring, so that members shared with another ring are counted in one pass.
class SharedSupport {
 public:
  explicit SharedSupport(const RingGraph& graph, std::size_t cluxels) : graph_(graph), mark_(cluxels, 0) {}
  void moveTo(std::uint32_t cluxel) {
    if (cluxel_ != kNobody)
      for (const auto member : graph_.neighbours(cluxel_)) mark_[member] = 0;
    cluxel_ = cluxel;
    for (const auto member : graph_.neighbours(cluxel)) mark_[member] = 1;
  }
  /// Shared members over all members of the two 1-rings (centres included): how much the supports of both ends overlap.
  /// `other` must be a neighbour.
  float shareWith(std::uint32_t other) const {
    const auto others = graph_.neighbours(other);
    std::int32_t shared = 2;  // the two are in each other's rings
    for (const auto member : others) shared += mark_[member];
    const auto both = static_cast<std::int32_t>(graph_.neighbours(cluxel_).size() + others.size());
    return static_cast<float>(shared) / static_cast<float>(both + 2 - shared);
  }

 private:
  static constexpr std::uint32_t kNobody = 0xffffffffU;
  const RingGraph& graph_;
  std::vector<std::uint8_t> mark_;
  std::uint32_t cluxel_ = kNobody;
};

using EdgeRow = std::array<float, kEdgeColumns>;

EdgeRow edgeRow(const EdgeEnd& a, const EdgeEnd& b, float shared) {
  const Eigen::Vector3d d = (b.center - a.center).cast<double>();
  const Eigen::Vector3d normal_a = a.normal.cast<double>(), normal_b = b.normal.cast<double>();
  const double distance = d.norm();
  return {static_cast<float>(distance), static_cast<float>(distance / (a.reach + b.reach)),
          static_cast<float>(std::abs(d.z())), static_cast<float>(std::min(1.0, std::abs(normal_a.dot(normal_b)))),
          // The larger distance of a centre from the other's plane [m]; 0 when neither has a plane.
          static_cast<float>(std::max(std::abs(normal_a.dot(d)), std::abs(normal_b.dot(d)))),
          static_cast<float>(std::abs(a.linearity - b.linearity)),
          static_cast<float>(std::abs(a.planarity - b.planarity)),
          static_cast<float>(std::abs(a.scattering - b.scattering)), volumeShare(a, b), shared};
}

/// Whether the row of an own cluxel's edge is stored at its other end.
bool isEarlierOwn(const RingCluxels& cluxels, std::uint32_t other, std::uint32_t own) {
  return other >= cluxels.own_begin && other < own;
}

std::size_t rowCount(const RingCluxels& cluxels, const RingGraph& graph) {
  std::size_t count = 0;
  for (std::uint32_t c = cluxels.own_begin; c < cluxels.own_end; ++c)
    for (const std::uint32_t other : graph.neighbours(c)) count += isEarlierOwn(cluxels, other, c) ? 0U : 1U;
  return count;
}

std::vector<EdgeEnd> edgeEnds(const FeatureInput& input) {
  std::vector<EdgeEnd> ends;
  ends.reserve(input.cluxels.size());
  for (std::size_t c = 0; c < input.cluxels.size(); ++c) ends.push_back(edgeEnd(input.cluxels, c, input.ball[c]));
  return ends;
}

}  // namespace

std::vector<std::string> edgeColumns() {
  return {"distance",       "distance_by_reach",    "height_difference",    "normals_parallel",
          "off_plane",      "linearity_difference", "planarity_difference", "scattering_difference",
          "volume_overlap", "support_overlap"};
}

void fillEdges(const FeatureInput& input, FeatureTile& tile) {
  const auto& cluxels = input.cluxels;
  const auto& graph = input.graph;
  const std::size_t first = graph.offset[cluxels.own_begin], count = graph.offset[cluxels.own_end] - first;
  tile.edge_target.reserve(count);
  tile.edge_offset.reserve(tile.size() + 1);
  tile.edge_row_offset.reserve(tile.size() + 1);
  const auto ends = edgeEnds(input);
  SharedSupport shared(graph, cluxels.size());
  tile.edge_features.reserve(rowCount(cluxels, graph) * kEdgeColumns);
  std::vector<EdgeRow> rows;  // of one cluxel
  for (std::uint32_t c = cluxels.own_begin; c < cluxels.own_end; ++c) {
    shared.moveTo(c);
    tile.edge_offset.push_back(static_cast<std::uint32_t>(graph.offset[c] - first));
    tile.edge_row_offset.push_back(static_cast<std::uint32_t>(tile.edge_features.size() / kEdgeColumns));
    rows.clear();
    for (const std::uint32_t other : graph.neighbours(c)) {
      tile.edge_target.push_back(cluxels.name[other]);
      if (!isEarlierOwn(cluxels, other, c)) rows.push_back(edgeRow(ends[c], ends[other], shared.shareWith(other)));
    }
    for (const EdgeRow& row : rows) tile.edge_features.insert(tile.edge_features.end(), row.begin(), row.end());
  }
  tile.edge_offset.push_back(static_cast<std::uint32_t>(count));
  tile.edge_row_offset.push_back(static_cast<std::uint32_t>(tile.edge_features.size() / kEdgeColumns));
}

}  // namespace cluxel::perception
