// SPDX-License-Identifier: Apache-2.0
// The groups of features. Each names its columns and fills them for the cluxels of a tile; see docs/features.md.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "perception/features/cluxel_graph.hpp"
#include "perception/features/eigen_shape.hpp"
#include "perception/features/feature_tile.hpp"

namespace cluxel::perception {

/// Input of the groups.
struct FeatureInput {
  const Ring<CluxelTile>& ring;
  const Ring<GroundTile>& ground;
  const RingCluxels& cluxels;
  const RingGraph& graph;
  const std::vector<EigenShape>& ball;       ///< of own and near cluxels
  const std::vector<std::uint32_t>& chosen;  ///< own cluxels of which rows are filled, ascending
  const CluxelTile& own() const { return *ring[kRingCentre]; }
};

/// The feature rows of all own cluxels, filled group by group.
class FeatureRows {
 public:
  FeatureRows(std::size_t rows, std::size_t columns) : columns_(columns), values_(rows * columns) {}
  /// `count` values of a row, from `column` on.
  std::span<float> row(std::size_t row, std::size_t column, std::size_t count) {
    return {values_.data() + row * columns_ + column, count};
  }
  std::vector<float> take() { return std::move(values_); }

 private:
  std::size_t columns_;
  std::vector<float> values_;
};

/// HOR, shapes and sizes of ball, 1-ring and 2-ring, and densities: what the supports in the graph tell.
std::vector<std::string> supportColumns(const FeatureParams& params);
void fillSupportFeatures(const FeatureInput& input, const FeatureParams& params, std::size_t column, FeatureRows& rows);

/// Shapes of wide cubes around a cluxel.
std::vector<std::string> wideColumns();
void fillWideFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

/// Height above ground, and the profile of the cell stacks around a cluxel.
std::vector<std::string> heightColumns();
void fillHeightFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

/// Occupied cells beside, above and below a cluxel.
std::vector<std::string> pillarColumns();
void fillPillarFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

std::vector<std::string> intensityColumns();
void fillIntensityFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows);

/// Features of edges; symmetric in both ends.
std::vector<std::string> edgeColumns();
void fillEdges(const FeatureInput& input, FeatureTile& tile);

}  // namespace cluxel::perception
