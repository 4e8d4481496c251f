// SPDX-License-Identifier: Apache-2.0
// Fourth stage: one row of features per cluxel, and the graph of intersecting cluxels. The CRF reads both.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/content_hash.hpp"
#include "base/free_memory.hpp"
#include "perception/clustering/cluxel_tile.hpp"
#include "perception/features/ground_tile.hpp"
#include "perception/tile.hpp"

namespace cluxel::perception {

/// Groups of features, described in docs/features.md. Scale-free and metric groups are switched separately.
struct FeatureParams {
  bool hor = true;         ///< histogram of oriented residuals of the 2-ring (scale-free)
  bool shape = true;       ///< eigenvalue shape and directions of ball, 1-ring, 2-ring (scale-free)
  bool wide_shape = true;  ///< the same in wide cubes, and their lengths (metric)
  bool height = true;      ///< height above the local ground and profile of the cell stacks around it (metric)
  bool pillar = true;      ///< what is occupied beside, above and below it within 1 m (metric)
  bool extent = true;      ///< sizes of the supports (metric)
  bool density = true;     ///< spacing of points and numbers of neighbours (metric)
  bool intensity = false;  ///< mean and spread of the intensity, 0 where a scan has none
};
void describe(FeatureParams& params, ParameterVisitor& visitor);

/// Beside what edges of the graph lead to, features read what lies this near to the tile [m].
inline constexpr double kFeatureMargin_m = 1.5;

/// Settings of all stages up to the features.
struct PerceptionParams {
  ThinParams thin;
  ClusterParams clustering;
  GroundParams ground;
  FeatureParams features;
};
void describe(PerceptionParams& params, ParameterVisitor& visitor);

/// The names of the feature columns and edge feature columns for one setting of the feature stage.
struct FeatureLayout {
  std::vector<std::string> columns;
  std::vector<std::string> edge_columns;
  /// Stored in every model file: a model accepts only features that were computed the same way.
  ContentHash hash() const;
};

/// Features and graph of one tile's own cluxels. Arrays are indexed by the cluxel's number in the tile.
struct FeatureTile {
  TileKey key;
  std::vector<Eigen::Vector3f> center;         ///< mean of own points, relative to the tile corner [m]
  std::vector<std::uint32_t> point_count;      ///< own points
  std::vector<float> features;                 ///< size() x columns, row-major
  std::vector<std::uint32_t> edge_offset;      ///< size() + 1: where each cluxel's edges begin
  std::vector<RingIndex> edge_target;          ///< own and neighbouring tiles' cluxels whose volumes intersect
  std::vector<std::uint32_t> edge_row_offset;  ///< size() + 1: how many rows of edge features come before each cluxel's
  std::vector<float> edge_features;  ///< a row of edge columns for each edge that hasRow(), in the order of edges

  std::size_t size() const { return edge_offset.empty() ? 0 : edge_offset.size() - 1; }
  /// False for a tile that was read: of it only the graph is stored. Only labelling needs the rest.
  bool hasRows() const { return size() == 0 || !features.empty(); }
  void dropRows() { freeMemory(center, point_count, features, edge_features); }
  /// Edge features are symmetric: an edge between own cluxels has its row at the end with the smaller number, an edge
  /// to another tile has a row in either tile.
  static bool hasRow(std::uint32_t cluxel, RingIndex target) {
    return target.ring != kRingCentre || target.index > cluxel;
  }
};

/// The columns that computeFeatures() fills with these settings.
FeatureLayout featureLayout(const FeatureParams& params);

/// Graph and features of the ring's centre tile. Cost: about 2.5 microseconds a cluxel on sparse scans.
FeatureTile computeFeatures(const Ring<CluxelTile>& cluxels, const Ring<GroundTile>& ground,
                            const FeatureParams& params);
/// Adds to a tile of which the graph is there the rows of some of its cluxels (ascending) and of their edges; those of
/// others are 0. Volumes may be missing of cluxels that no two edges of the graph lead to from these. Throws Error
/// (StoreUnavailable) when the graph is not that of the cluxels.
void addRows(const Ring<CluxelTile>& cluxels, const Ring<GroundTile>& ground, const FeatureParams& params,
             const std::vector<std::uint32_t>& chosen, FeatureTile& tile);

/// Stores the graph.
std::string toBytes(const FeatureTile& tile);
/// The graph without rows, of so many cluxels. Throws Error (StoreUnavailable) when the bytes are damaged, of another
/// kind or of another number of cluxels.
FeatureTile featureTileFromBytes(std::string_view bytes, std::size_t cluxel_count);

/// Output of the labelling stage, per cluxel of the tile.
struct LabelTile {
  TileKey key;
  std::vector<std::uint8_t> label;                ///< PrimitiveLabel
  std::vector<std::array<float, 5>> probability;  ///< calibrated; sums to 1
};

}  // namespace cluxel::perception
