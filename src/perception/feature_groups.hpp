// SPDX-License-Identifier: Apache-2.0
// The groups of features: each names its columns and fills them for a tile's cluxels. docs/features.md explains them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cluxel/perception/feature_tile.hpp"
#include "perception/cluxel_graph.hpp"
#include "perception/eigen_shape.hpp"

namespace cluxel {

/// What the groups compute from.
struct FeatureInput {
  const Ring<CluxelTile>& ring;
  const Ring<GroundTile>& ground;
  const RingCluxels& cluxels;
  const RingGraph& graph;
  const std::vector<EigenShape>& ball;  ///< of own and near cluxels
  const CluxelTile& own() const { return *ring[kRingCentre]; }
};

/// Rows of numbers of all own cluxels, filled group by group.
class FeatureRows {
 public:
  FeatureRows(std::size_t rows, std::size_t columns) : columns_(columns), values_(rows * columns) {}
  /// Where `count` values of a row begin at a column.
  std::span<float> row(std::size_t row, std::size_t column, std::size_t count) {
    return {values_.data() + row * columns_ + column, count};
  }
  std::vector<float> take() { return std::move(values_); }

 private:
  std::size_t columns_;
  std::vector<float> values_;
};

/// HOR, shapes of ball, 1-ring and 2-ring, their sizes, and densities: what the graph's supports tell.
std::vector<std::string> supportColumns(const FeatureParams& params);
void fillSupportFeatures(const FeatureInput& input, const FeatureParams& params, std::size_t column, FeatureRows& rows);

/// Shapes of wide cubes around a cluxel.
std::vector<std::string> wideColumns();
void fillWideFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

/// Height above ground, and what stands in the map columns around a cluxel.
std::vector<std::string> heightColumns();
void fillHeightFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

/// Occupied cells beside, above and below a cluxel.
std::vector<std::string> pillarColumns();
void fillPillarFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

std::vector<std::string> intensityColumns();
void fillIntensityFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

/// Features of edges: the same number from both ends.
std::vector<std::string> edgeColumns();
void fillEdges(const FeatureInput& input, FeatureTile& tile);

}  // namespace cluxel
