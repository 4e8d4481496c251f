// SPDX-License-Identifier: Apache-2.0
// Sixth stage: connected cluxels of one label within one tile, with summaries that merge over tiles into primitives.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "perception/clustering/cluxel_tile.hpp"
#include "perception/clustering/tile_points.hpp"
#include "perception/features/feature_tile.hpp"
#include "perception/features/ground_tile.hpp"
#include "perception/stage_params.hpp"
#include "scan/truth/primitive_label.hpp"

namespace cluxel::perception {

struct ComponentParams {
  double max_gap_m = 0.50;  ///< intersecting cluxels of one label join when the boxes of their points are this near
};
void describe(ComponentParams& params, ParameterVisitor& visitor);

/// The edge of a footprint cell [m], and the number of cells along a tile.
inline constexpr double kFootprintCell_m = 0.25;
inline constexpr int kFootprintCellsPerTile = 64;

/// The points of one component in one footprint cell.
struct FootprintCell {
  std::uint16_t x = 0, y = 0;         ///< cell within the tile
  std::uint32_t count = 0;            ///< points
  std::array<float, 3> min{}, max{};  ///< their box, relative to the tile's corner [m]
  float mean_z = 0;                   ///< [m, map]
  float lowest = 0, highest = 0;      ///< above the local ground [m]
};

/// One component: sums and extremes that merge over tiles. Lengths are relative to the tile's corner [m].
struct Component {
  std::uint32_t label = 0;  ///< PrimitiveLabel
  std::uint32_t points = 0, cluxels = 0;
  std::uint32_t first_cluxel = 0;  ///< its smallest cluxel number
  std::array<double, 3> mean{};
  std::array<double, 6> scatter{};  ///< sums of products of deviations xx xy xz yy yz zz [m2]
  std::array<double, scan::kPrimitiveLabelCount> probability{};  ///< summed over points
  double intensity = 0;                                          ///< summed over points; 0 without intensity
  std::array<float, 3> min{}, max{};
  float lowest = 0, highest = 0;  ///< above the local ground [m]
};

/// The components of one tile, with CSR lists per component.
struct ComponentTile {
  TileKey key;
  std::vector<std::uint32_t> component_of;  ///< per cluxel of the tile
  std::vector<Component> components;        ///< in the order of their first cluxels
  std::vector<std::uint32_t> cell_offset;   ///< size() + 1
  std::vector<FootprintCell> cells;         ///< row by row in y
  std::vector<std::uint32_t> hull_offset;   ///< size() + 1
  std::vector<Eigen::Vector2f> hull;        ///< convex hull seen from above, counter-clockwise
  std::vector<std::uint32_t> scan_offset;   ///< size() + 1
  std::vector<scan::ScanId> scans;          ///< scans with a point in it, ascending

  std::size_t size() const { return components.size(); }
  std::span<const FootprintCell> cellsOf(std::size_t component) const {
    return {cells.data() + cell_offset[component], cells.data() + cell_offset[component + 1]};
  }
};

/// Components of the ring's centre tile from its labels, its part of the graph and the surrounding ground.
/// Cost: about 150 ns a point.
ComponentTile componentsOf(const TilePoints& points, const CluxelTile& cluxels, const FeatureTile& graph,
                           const LabelTile& labels, const Ring<GroundTile>& ground, const ComponentParams& params);

/// The distance between two boxes [m]; 0 when they intersect.
inline float gapBetween(const Eigen::Vector3f& min_a, const Eigen::Vector3f& max_a, const Eigen::Vector3f& min_b,
                        const Eigen::Vector3f& max_b) {
  const auto along = [&](int i) { return std::max(std::max(min_a[i] - max_b[i], min_b[i] - max_a[i]), 0.0F); };
  const float x = along(0), y = along(1), z = along(2);
  return std::sqrt(x * x + (y * y + z * z));
}

std::string toBytes(const ComponentTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
ComponentTile componentTileFromBytes(std::string_view bytes);

}  // namespace cluxel::perception
