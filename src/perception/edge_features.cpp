// SPDX-License-Identifier: Apache-2.0
// Features of edges. Places of both ends are exact floats and every formula is symmetric, so both tiles of a border agree.
#include <algorithm>
#include <cmath>

#include "perception/feature_groups.hpp"

namespace cluxel {
namespace {

/// Volumes are widened by this when their overlap is measured: flat and single-point volumes have none [m].
constexpr float kLeastThickness_m = 0.02F;

/// Shapes of the balls of own cluxels and of those that edges lead to.
std::vector<EigenShape> ballShapes(const FeatureInput& input) {
  std::vector<EigenShape> shapes(input.cluxels.size());
  for (std::size_t c = 0; c < shapes.size(); ++c)
    if (input.cluxels.near[c]) {
      const RingIndex name = input.cluxels.name[c];
      shapes[c] = shapeOf(tileOfCluxel(input.ring, name).ball[name.index]);
    }
  return shapes;
}

/// Common volume over the smaller volume, in [0, 1].
float volumeShare(const Volume& a, const Volume& b) {
  const auto widened = [](const Eigen::Vector3f& size) -> Eigen::Vector3f { return size.array() + kLeastThickness_m; };
  const Eigen::Vector3f common = widened(a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low));
  const Eigen::Vector3f size_a = widened(a.high - a.low), size_b = widened(b.high - b.low);
  return common.prod() / std::min(size_a.prod(), size_b.prod());
}

/// Shared members over all members of the two 1-rings, each with its centre: how much the features of both rest on the same.
float supportShare(const RingGraph& graph, std::uint32_t a, std::uint32_t b) {
  const auto of_a = graph.neighbours(a), of_b = graph.neighbours(b);
  std::size_t shared = 2;   // a and b are each other's neighbours
  for (std::size_t i = 0, j = 0; i < of_a.size() && j < of_b.size();) {
    if (of_a[i] == of_b[j]) ++shared;
    const bool next_a = of_a[i] <= of_b[j], next_b = of_b[j] <= of_a[i];
    i += next_a ? 1 : 0;
    j += next_b ? 1 : 0;
  }
  return static_cast<float>(shared) / static_cast<float>(of_a.size() + of_b.size() + 2 - shared);
}

/// How far each centre lies off the other's plane [m]; the larger one. 0 when neither has a plane.
double offPlane(const EigenShape& a, const EigenShape& b, const Eigen::Vector3d& d) {
  return std::max(std::abs(a.normal.dot(d)), std::abs(b.normal.dot(d)));
}

void putEdge(const FeatureInput& input, const std::vector<EigenShape>& shapes, std::uint32_t a, std::uint32_t b,
             std::vector<float>& out) {
  const auto& cluxels = input.cluxels;
  const Eigen::Vector3d d = (cluxels.center[b] - cluxels.center[a]).cast<double>();
  const auto reachOf = [&](std::uint32_t c) {
    return tileOfCluxel(input.ring, cluxels.name[c]).reach[cluxels.name[c].index];
  };
  const EigenShape &shape_a = shapes[a], &shape_b = shapes[b];
  const double distance = d.norm();
  const auto put = [&](double value) { out.push_back(static_cast<float>(value)); };
  put(distance);
  put(distance / (reachOf(a) + reachOf(b)));
  put(std::abs(d.z()));
  put(std::min(1.0, std::abs(shape_a.normal.dot(shape_b.normal))));
  put(offPlane(shape_a, shape_b, d));
  put(std::abs(shape_a.linearity() - shape_b.linearity()));
  put(std::abs(shape_a.planarity() - shape_b.planarity()));
  put(std::abs(shape_a.scattering() - shape_b.scattering()));
  put(volumeShare(cluxels.volume[a], cluxels.volume[b]));
  put(supportShare(input.graph, a, b));
}

}  // namespace

std::vector<std::string> edgeColumns() {
  return {"distance", "distance_by_reach", "height_difference", "normals_parallel", "off_plane", "linearity_difference",
          "planarity_difference", "scattering_difference", "volume_overlap", "support_overlap"};
}

void fillEdges(const FeatureInput& input, FeatureTile& tile) {
  const auto shapes = ballShapes(input);
  const auto& cluxels = input.cluxels;
  tile.edge_offset.push_back(0);
  for (std::uint32_t c = cluxels.own_begin; c < cluxels.own_end; ++c) {
    for (const auto other : input.graph.neighbours(c)) {
      tile.edge_target.push_back(cluxels.name[other]);
      putEdge(input, shapes, c, other, tile.edge_features);
    }
    tile.edge_offset.push_back(static_cast<std::uint32_t>(tile.edge_target.size()));
  }
}

}  // namespace cluxel
