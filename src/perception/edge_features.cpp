// SPDX-License-Identifier: Apache-2.0
// Features of edges. Places of both ends are exact floats and every formula is symmetric, so both tiles of a border agree.
#include <algorithm>
#include <array>
#include <cmath>

#include "perception/feature_groups.hpp"

namespace cluxel {
namespace {

/// Volumes are widened by this when their overlap is measured: flat and single-point volumes have none [m].
constexpr float kLeastThickness_m = 0.02F;
constexpr std::size_t kEdgeColumns = 10;

/// Common volume over the smaller volume, in [0, 1].
float volumeShare(const Volume& a, const Volume& b) {
  const auto widened = [](const Eigen::Vector3f& size) -> Eigen::Vector3f { return size.array() + kLeastThickness_m; };
  const Eigen::Vector3f common = widened(a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low));
  const Eigen::Vector3f size_a = widened(a.high - a.low), size_b = widened(b.high - b.low);
  return common.prod() / std::min(size_a.prod(), size_b.prod());
}

/// Members of one cluxel's 1-ring carry a mark, so that others' shared members are counted in one run over theirs.
class SharedSupport {
 public:
  explicit SharedSupport(const RingGraph& graph, std::size_t cluxels) : graph_(graph), mark_(cluxels, 0) {}
  void moveTo(std::uint32_t cluxel) {
    if (cluxel_ != kNobody)
      for (const auto member : graph_.neighbours(cluxel_)) mark_[member] = 0;
    cluxel_ = cluxel;
    for (const auto member : graph_.neighbours(cluxel)) mark_[member] = 1;
  }
  /// Shared members over all members of the two 1-rings, each with its centre: how much the features of both ends rest on
  /// the same. `other` is a neighbour.
  float shareWith(std::uint32_t other) const {
    const auto others = graph_.neighbours(other);
    std::int32_t shared = 2;   // the two are in each other's rings
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

/// How far each centre lies off the other's plane [m]; the larger one. 0 when neither has a plane.
double offPlane(const EigenShape& a, const EigenShape& b, const Eigen::Vector3d& d) {
  return std::max(std::abs(a.normal.dot(d)), std::abs(b.normal.dot(d)));
}

using EdgeRow = std::span<float, kEdgeColumns>;

/// What is the same for all edges of a cluxel.
struct BallForm {
  double linearity, planarity, scattering;
};

std::vector<BallForm> formsOf(const std::vector<EigenShape>& shapes) {
  std::vector<BallForm> forms;
  forms.reserve(shapes.size());
  for (const auto& shape : shapes) forms.push_back({shape.linearity(), shape.planarity(), shape.scattering()});
  return forms;
}

void fillEdge(const FeatureInput& input, const std::vector<BallForm>& forms, std::uint32_t a, std::uint32_t b,
              const SharedSupport& shared, EdgeRow out, EdgeRow mirrored) {
  const auto& cluxels = input.cluxels;
  const Eigen::Vector3d d = (cluxels.center[b] - cluxels.center[a]).cast<double>();
  const EigenShape &shape_a = input.ball[a], &shape_b = input.ball[b];
  const BallForm &form_a = forms[a], &form_b = forms[b];
  const double distance = d.norm();
  const std::array<double, kEdgeColumns - 2> values{distance,
                                                    distance / (cluxels.reach[a] + cluxels.reach[b]),
                                                    std::abs(d.z()),
                                                    std::min(1.0, std::abs(shape_a.normal.dot(shape_b.normal))),
                                                    offPlane(shape_a, shape_b, d),
                                                    std::abs(form_a.linearity - form_b.linearity),
                                                    std::abs(form_a.planarity - form_b.planarity),
                                                    std::abs(form_a.scattering - form_b.scattering)};
  // Written to both rows at once: to copy what was just written would wait for it.
  const auto put = [&](std::size_t i, float value) { out[i] = mirrored[i] = value; };
  for (std::size_t i = 0; i < values.size(); ++i) put(i, static_cast<float>(values[i]));
  put(kEdgeColumns - 2, volumeShare(cluxels.volume[a], cluxels.volume[b]));
  put(kEdgeColumns - 1, shared.shareWith(b));
}

}  // namespace

std::vector<std::string> edgeColumns() {
  return {"distance", "distance_by_reach", "height_difference", "normals_parallel", "off_plane", "linearity_difference",
          "planarity_difference", "scattering_difference", "volume_overlap", "support_overlap"};
}

void fillEdges(const FeatureInput& input, FeatureTile& tile) {
  const auto& cluxels = input.cluxels;
  const auto& graph = input.graph;
  const std::size_t first = graph.offset[cluxels.own_begin], count = graph.offset[cluxels.own_end] - first;
  tile.edge_features.resize(count * kEdgeColumns);
  tile.edge_target.reserve(count);
  const auto rowOf = [&](std::size_t edge) { return EdgeRow(tile.edge_features.data() + (edge - first) * kEdgeColumns, kEdgeColumns); };
  // Own cluxels come to a target in ascending order, as its own edges to them stand: `back` is the next of these.
  std::vector<std::uint32_t> back(graph.offset.begin(), graph.offset.end());
  SharedSupport shared(graph, cluxels.size());
  const auto forms = formsOf(input.ball);
  std::array<float, kEdgeColumns> nobodys{};   // the row of ends in other tiles
  for (std::uint32_t c = cluxels.own_begin; c < cluxels.own_end; ++c) {
    shared.moveTo(c);
    tile.edge_offset.push_back(static_cast<std::uint32_t>(graph.offset[c] - first));
    for (std::uint32_t edge = graph.offset[c]; edge < graph.offset[c + 1]; ++edge) {
      const std::uint32_t other = graph.target[edge];
      tile.edge_target.push_back(cluxels.name[other]);
      const bool is_own = other >= cluxels.own_begin && other < cluxels.own_end;
      if (is_own && other < c) continue;
      if (is_own)
        while (graph.target[back[other]] < cluxels.own_begin) ++back[other];
      fillEdge(input, forms, c, other, shared, rowOf(edge), is_own ? rowOf(back[other]++) : EdgeRow(nobodys));
    }
  }
  tile.edge_offset.push_back(static_cast<std::uint32_t>(count));
}

}  // namespace cluxel
