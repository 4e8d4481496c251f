// SPDX-License-Identifier: Apache-2.0
// What the scene and the layers above it read of a tile's points and cluxels: they need not read the points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "perception/clustering/cluxel_tile.hpp"
#include "perception/clustering/tile_points.hpp"

namespace cluxel::perception {

/// Along x, y, z [mm], rounded.
using ViewShift = std::array<std::int16_t, 3>;

/// The cluxels of one tile as a structure of arrays. Lengths are relative to the tile's corner, z is the map's [m].
struct SummaryTile {
  TileKey key;
  std::vector<scan::ScanId> scans;               ///< as TilePoints::scans
  std::vector<std::uint32_t> seed_scan;          ///< index into `scans`
  std::vector<std::uint32_t> seed_point;         ///< the seed's number in that scan
  std::vector<std::uint32_t> point_count;        ///< own points
  std::vector<Eigen::Vector3f> mean;             ///< of own points
  std::vector<Eigen::Vector3f> box_min, size_m;  ///< of the box around own points
  std::vector<std::uint32_t> view_offset;        ///< size() + 1: where the views of each cluxel begin
  std::vector<std::uint32_t> view_scan;          ///< index into `scans`, ascending within a cluxel
  std::vector<std::uint32_t> view_point_count;   ///< own points that this scan measured
  std::vector<ViewShift> view_shift;             ///< of their mean from the cluxel's mean

  std::size_t size() const { return seed_point.size(); }
  /// Of the cluxel's points that a scan measured, from the tile's corner [m]; within 1 mm.
  Eigen::Vector3d viewMean(std::size_t cluxel, std::size_t view) const {
    const auto& [x, y, z] = view_shift[view];
    return mean[cluxel].cast<double>() + 0.001 * Eigen::Vector3d(x, y, z);
  }
};

/// Cost: about 15 ns a point.
SummaryTile summaryOf(const TilePoints& points, const CluxelTile& cluxels);

std::string toBytes(const SummaryTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
SummaryTile summaryTileFromBytes(std::string_view bytes);
/// Reads only key, scans, seeds and means; all else is empty.
SummaryTile seedsFromBytes(std::string_view bytes);
/// How many cluxels the bytes have.
std::size_t cluxelsIn(std::string_view bytes);

}  // namespace cluxel::perception
