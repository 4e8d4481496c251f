// SPDX-License-Identifier: Apache-2.0
// Output of the feature stage: one row of numbers per cluxel, and the graph of intersecting cluxels. The CRF reads it.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "cluxel/base/content_hash.hpp"
#include "cluxel/perception/tile.hpp"

namespace cluxel {

/// The names of the feature columns and edge feature columns that one setting of the feature stage computes.
struct FeatureLayout {
  std::vector<std::string> columns;
  std::vector<std::string> edge_columns;
  /// Stands in every model file: a model reads only features that were made the same way.
  ContentHash hash() const;
};

/// Features and graph of one tile's own cluxels. Arrays are indexed by the cluxel's number in the tile.
struct FeatureTile {
  TileKey key;
  std::vector<Eigen::Vector3f> center;        ///< mean of own points, relative to the tile corner [m]
  std::vector<std::uint32_t> point_count;     ///< own points
  std::vector<float> features;                ///< size() x columns, row-major
  std::vector<std::uint32_t> edge_offset;     ///< size() + 1: where each cluxel's edges begin
  std::vector<RingIndex> edge_target;         ///< own and neighbouring tiles' cluxels whose volumes intersect
  std::vector<float> edge_features;           ///< edges x edge columns, row-major; the same value seen from both ends

  std::size_t size() const { return center.size(); }
};

/// Output of the labelling stage, per cluxel of the tile.
struct LabelTile {
  TileKey key;
  std::vector<std::uint8_t> label;                                     ///< PrimitiveLabel
  std::vector<std::array<float, 5>> probability;                       ///< calibrated; sums to 1
};

}  // namespace cluxel
