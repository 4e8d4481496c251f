// SPDX-License-Identifier: Apache-2.0
// First stage: the points of all scans in a tile, thinned where scans overlap, in an order independent of arrival
// order.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "perception/stage_params.hpp"
#include "perception/tile.hpp"
#include "scan/scan.hpp"

namespace cluxel::perception {

using scan::kMaxHeight_m;

struct ThinParams {
  double voxel_m = 0.05;  ///< width of the voxels that are thinned; about as high
  int keep = 2;           ///< points kept per voxel
};
void describe(ThinParams& params, ParameterVisitor& visitor);

/// The points of one scan in one tile, ascending by point number. x and y are relative to the tile's corner, z is the
/// grid's [m]; `intensity` is empty or as long as x.
struct ScanSegment {
  TileKey key;
  scan::ScanId scan;
  std::vector<float> x, y, z, intensity;
  std::vector<std::uint32_t> point;  ///< index in the scan
  std::vector<std::uint32_t> rank;   ///< hash of what was measured: the rank by which points are kept

  std::size_t size() const { return x.size(); }
};

/// The thinned points of one tile, sorted by (voxel, scan id, point). Arrays have one length; `intensity` may be empty
/// (when no scan of the tile has one; a scan without one counts as 0 otherwise).
struct TilePoints {
  TileKey key;
  std::vector<scan::ScanId> scans;  ///< ascending; scans with a point in this tile before thinning
  std::vector<float> x, y, z, intensity;
  std::vector<std::uint32_t> scan;   ///< index into `scans`
  std::vector<std::uint32_t> point;  ///< index in that scan
  std::vector<std::uint32_t> rank;   ///< as in ScanSegment

  std::size_t size() const { return x.size(); }
  Eigen::Vector3f at(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Local coordinates of a map point in the tile that holds it, rounded as splitScan() does.
Eigen::Vector3f localPoint(const TileGrid& grid, const TileKey& key, const Eigen::Vector3d& p_map);

/// Cuts a scan into its tiles. Throws InputError naming the scan and point when a coordinate is not finite or too
/// large. Cost: about 20 ns a point.
std::map<TileKey, ScanSegment> splitScan(const scan::Scan& scan, const TileGrid& grid);

/// Keeps in each voxel the `keep` points with the smallest ranks (ties: by scan id and point): the choice depends on
/// what was measured, neither on times, the order of the segments nor earlier thinning. Segments must be of tile `key`
/// and of different scans.
TilePoints thin(const TileKey& key, std::span<const ScanSegment* const> segments, const ThinParams& params);

/// The same from points already thinned with the same settings: thin(thin(A), thin(B)) equals thin(A and B).
TilePoints thin(const TileKey& key, std::span<const TilePoints* const> parts, const ThinParams& params);

/// Finds the kept point that represents a point of the tile, thinned away or not: the nearest kept one of the same
/// voxel (ties: the first). Holds no copy of the points; `points` must outlive it.
class RepresentativeFinder {
 public:
  /// `grid`: of the map for which the points were thinned.
  RepresentativeFinder(const TilePoints& points, const ThinParams& params, const TileGrid& grid = {});
  /// Index into the tile's points; `p_local` as from localPoint(). For a point that is not of the tile's scans, the
  /// nearest kept point of the voxel or, when it has none, kNone. Cost O(log n).
  std::uint32_t find(const Eigen::Vector3f& p_local) const;
  static constexpr std::uint32_t kNone = 0xffffffffU;

 private:
  const TilePoints& points_;
  double voxel_m_;
  bool whole_layers_;
  std::vector<std::uint64_t> voxel_;  ///< per point, ascending
};

/// Stores which points of which scans they are.
std::string toBytes(const TilePoints& tile);
/// Names of points; coordinates, intensities and ranks are 0 until PointsFromScans has filled them in. Throws Error
/// (StoreUnavailable) when the bytes are damaged or of another kind.
TilePoints tilePointsFromBytes(std::string_view bytes);

/// Fills tiles that were read with the measured values, from one scan after the other.
class PointsFromScans {
 public:
  explicit PointsFromScans(const TileGrid& grid) : grid_(grid) {}
  /// `tile` must stay where it is.
  void add(TilePoints& tile);
  /// The scans whose points are needed.
  std::vector<scan::ScanId> scans() const;
  /// Sets the values of all points of `scan`, with the bits that splitScan() gives them. Throws Error
  /// (StoreUnavailable) when a tile names a point that is not in the scan, or not in the tile. Cost: about 30 ns a
  /// point.
  void fill(const scan::Scan& scan) const;

 private:
  struct Part {
    TilePoints* tile;
    std::vector<std::uint32_t> points;  ///< indices in the tile
  };
  TileGrid grid_;
  std::map<scan::ScanId, std::vector<Part>> parts_;
};

}  // namespace cluxel::perception
