// SPDX-License-Identifier: Apache-2.0
// The points of a map as tiles for the page: quantised, with their object, in levels of detail.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/map_reader.hpp"
#include "mapping/regions/tile_objects.hpp"

namespace cluxel::tasks {

inline constexpr double kViewTile_m = 16, kViewQuantum_m = 0.005;
/// Heights above the local ground are one byte: kLowestHeight_m + byte * kShownHeightStep_m, cut at both ends.
inline constexpr double kLowestHeight_m = -2, kShownHeightStep_m = 0.125;
inline constexpr std::size_t kViewLevels = 4;

/// One square of the map seen from above. Points of a level are a uniform sample, so that the first levels alone show
/// the whole tile coarsely.
struct PointTile {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< corner with the minimum coordinates [m, map]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< of the box around its points, from the origin [m]
  double z_quantum_m = kViewQuantum_m;
  std::array<std::uint32_t, kViewLevels> points_to{};  ///< the number of points up to and with each level
  /// Planes of bytes for all points: x, y, z (2 bytes each, quanta from the origin), number of the object + 1 or 0 (3),
  /// cloud (2), intensity (1), height above the ground (1), primitive label (1).
  std::string planes;
};

/// Place of a tile among those of its size: its corner is at (x, y) * kViewTile_m.
using ViewTileKey = std::pair<std::int64_t, std::int64_t>;

struct PointTiles {
  std::vector<PointTile> tiles;                 ///< by x, then y
  std::array<double, 2> intensity{};            ///< the values of bytes 0 and 255; equal when there are none
  std::uint64_t points = 0, points_in_map = 0;  ///< shown, and all
};

/// The clouds of the map by time, those without a time first: their places are the numbers of clouds in the page.
std::vector<mapping::Cloud> cloudsByTime(const mapping::MapReader& map);

/// Names what the numbers of objects and clouds in tiles refer to: a hash of the map's clouds, their poses and objects.
std::string tileStateOf(const mapping::MapReader& map);

/// All points of single tiles. Keeps the points of some clouds, since neighbouring tiles are wanted one after the
/// other, and the map's tiles of the last ones: some 250 MB at most, and 8 bytes a cluxel. For one state of a map.
/// Thread-safe: callers wait for each other when they want a cloud that one of them is reading, and while one finds the
/// objects of a cloud's points.
class PointTileSource {
 public:
  explicit PointTileSource(const mapping::MapReader& map);
  ~PointTileSource();
  PointTileSource(PointTileSource&&) noexcept;

  const std::string& state() const { return state_; }
  /// Absent when no point lies there. `intensity` are the values of bytes 0 and 255. `map` is the one of the
  /// constructor, or another reader of its state. Cost: the points of the clouds that reach the tile.
  std::optional<PointTile> tile(const mapping::MapReader& map, const ViewTileKey& key,
                                const std::array<double, 2>& intensity) const;

 private:
  struct CloudPoints;
  struct Kept;
  std::shared_ptr<CloudPoints> placeOf(std::size_t cloud) const;

  std::string state_;
  std::vector<mapping::Cloud> clouds_;  ///< by time
  std::unique_ptr<Kept> kept_;
};

/// A line of JSON (origin, size, zQuantum, pointsTo), then the planes.
std::string tileBytes(const PointTile& tile);

/// At most about `max_points` points: of a larger map a uniform sample, the same for the same map.
PointTiles pointTilesOf(const mapping::MapReader& map, std::uint64_t max_points);

}  // namespace cluxel::tasks
