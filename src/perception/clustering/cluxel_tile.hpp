// SPDX-License-Identifier: Apache-2.0
// Second stage: cluxels (paper section 3.1), each a seed and the points near it, with bounding volumes and moments.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "perception/clustering/tile_points.hpp"

namespace cluxel::perception {

/// The largest reach of a bounding volume that settings allow [m]; far less than a tile.
inline constexpr double kMaxReach_m = 2.0;

struct ClusterParams {
  double radius_m = 0.20;     ///< a point joins the earliest seed of its tile within this distance
  double max_reach_m = 0.60;  ///< volumes of sparse cluxels grow up to this; equal to radius_m: fixed volumes
  int target_points = 8;      ///< a volume grows until it holds this many points
};
void describe(ClusterParams& params, ParameterVisitor& visitor);

/// Count, mean and centred second moments of a set of points. Moments of disjoint sets can be merged. Sums run in
/// double and in a fixed order, so that equal inputs give equal bytes.
struct Moments {
  float count = 0;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();  ///< relative to the tile's corner, z of the map [m]
  std::array<float, 6> scatter{};                  ///< sums of products of deviations xx xy xz yy yz zz [m2]
};

/// A vertical stack of cells with an edge of kStackSize_m: which of its slices of kSliceHeight_m hold points.
struct CellStack {
  float low = 0;                ///< mean of the points within 0.1 m of the lowest [m, map]
  float high = 0;               ///< highest point [m, map]
  std::uint32_t count = 0;      ///< points; with 0, low and high are undefined
  std::int32_t base_slice = 0;  ///< floor(lowest z / kSliceHeight_m)
  std::uint64_t slices = 0;     ///< bit i: a point lies in slice base_slice + i; the last bit: or above
};
inline constexpr double kStackSize_m = 0.5;
inline constexpr int kStacksPerTile = 32;
inline constexpr double kSliceHeight_m = 0.25;

/// Cluxels of one tile as a structure of arrays, numbered in the order of their seeds in the canonical order.
struct CluxelTile {
  TileKey key;
  std::vector<std::uint32_t> seed;                      ///< index into the tile's points
  std::vector<Moments> own;                             ///< of the cluxel's own points
  std::vector<Eigen::Vector3f> box_min, box_max;        ///< of the own points, relative to the tile's corner [m]
  std::vector<Eigen::Vector3f> volume_min, volume_max;  ///< of all points within reach of the seed, neighbours' too [m]
  std::vector<Moments> ball;                            ///< of all points within reach of the seed
  std::vector<float> reach;                             ///< [m]
  std::vector<float> intensity_mean, intensity_deviation;  ///< of own points; empty without intensity
  std::vector<std::uint32_t> point_cluxel;                 ///< per point of the tile: its cluxel
  std::vector<CellStack> stacks;                           ///< kStacksPerTile squared, row by row in y

  std::size_t size() const { return seed.size(); }
  /// False for a tile that was read: volumes, balls and reaches are not stored. Only features need them.
  bool hasVolumes() const { return reach.size() == size(); }
};

/// "A point joins the earliest seed within the radius, or becomes a seed", in canonical order (cell, then the
/// order of the points), with seeds of the own tile only. Cells are those of gridOf() for the radius: for 0.20 m they
/// are 0.20002 m wide and 0.2025 m high. Points of neighbouring tiles extend volumes and balls. Cost: about 200 ns a
/// point.
CluxelTile clusterTile(const Ring<TilePoints>& ring, const ClusterParams& params);

/// Computes volumes, balls and reaches of `chosen` cluxels (ascending) of the centre tile again, with the same bits.
/// Others get a volume that meets nothing. Cost: of all cluxels about half of clusterTile().
void addVolumes(const Ring<TilePoints>& ring, const ClusterParams& params, std::vector<std::uint32_t> chosen,
                CluxelTile& tile);
/// Gives up volumes, balls and reaches.
void dropVolumes(CluxelTile& tile);

/// Stores seeds, and the cluxel of each point.
std::string toBytes(const CluxelTile& tile);
/// Cluxels without volumes; moments, boxes and stacks are computed from `points`, those of the tile. Throws Error
/// (StoreUnavailable) when the bytes are damaged, of another kind or of other points.
CluxelTile cluxelTileFromBytes(std::string_view bytes, const TilePoints& points);

}  // namespace cluxel::perception
