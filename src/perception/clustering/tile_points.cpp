// SPDX-License-Identifier: Apache-2.0
// Thinning sorts the points by voxel and keeps, per voxel, those with the smallest ranks.
#include "perception/clustering/tile_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/mixed_bits.hpp"
#include "base/radix_order.hpp"
#include "cluxel/error.hpp"
#include "perception/clustering/local_steps.hpp"

namespace cluxel::perception {
namespace {

/// The voxel of a local point as an integer that sorts by x, then y, then z. Wide enough for voxels of 1 cm.
class VoxelKeys {
 public:
  /// A whole number of layers is as high as a tile is wide, as in CellKeys; not so in maps of earlier versions.
  explicit VoxelKeys(double voxel_m, bool whole_layers = true)
      : per_m_(1.0 / voxel_m),
        layers_per_m_(whole_layers ? std::round(kTileSize_m / voxel_m) / kTileSize_m : per_m_),
        height_offset_m_(kMaxHeight_m + (whole_layers ? kTileSize_m : 1.0)) {}
  std::uint64_t operator()(float x, float y, float z) const {
    return cell(x * per_m_) << 36U | cell(y * per_m_) << 24U | cell((z + height_offset_m_) * layers_per_m_);
  }

 private:
  static std::uint64_t cell(double voxels) { return static_cast<std::uint64_t>(std::max(0.0, voxels)); }
  double per_m_, layers_per_m_, height_offset_m_;
};

/// The concatenated points of all parts, each with its index into the scans.
struct Pool {
  std::vector<float> x, y, z, intensity;
  std::vector<std::uint32_t> scan, point, rank;
};

/// A hash of the measured values of a point, in the sensor frame: a pose, a time or the map's origin does not change
/// it.
std::uint32_t rankOf(const scan::ScanPoints& points, std::size_t i) {
  const auto two = [](float high, float low) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(high)} << 32U | std::bit_cast<std::uint32_t>(low);
  };
  const float intensity = points.intensity.empty() ? 0.0F : points.intensity[i];
  const std::uint64_t plane = mixedBits(two(points.x[i], points.y[i]) + kSplitMixStep);
  return static_cast<std::uint32_t>(mixedBits(plane + kSplitMixStep + two(points.z[i], intensity)) >> 32U);
}

/// Reduces one voxel's items to the kept ones, in the order (scan, point).
void keepSome(std::vector<std::uint32_t>& items, const Pool& pool, std::size_t keep) {
  const auto name = [&](std::uint32_t i) { return std::pair(pool.scan[i], pool.point[i]); };
  const auto by_name = [&](std::uint32_t a, std::uint32_t b) { return name(a) < name(b); };
  std::sort(items.begin(), items.end(), by_name);
  items.erase(std::unique(items.begin(), items.end(), [&](auto a, auto b) { return name(a) == name(b); }), items.end());
  if (items.size() <= keep) return;
  const auto rank = [&](std::uint32_t i) { return std::pair(pool.rank[i], name(i)); };
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(keep), items.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
  items.resize(keep);
  std::sort(items.begin(), items.end(), by_name);
}

/// The kept items of the pool in canonical order.
std::vector<std::uint32_t> keptOf(const Pool& pool, const ThinParams& params) {
  const VoxelKeys voxel(params.voxel_m);
  std::vector<std::uint64_t> keys(pool.x.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = voxel(pool.x[i], pool.y[i], pool.z[i]);
  const std::vector<std::uint32_t> order = orderOf(keys);
  std::vector<std::uint32_t> kept, items;
  kept.reserve(order.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const std::uint64_t key = keys[order[begin]];
    for (end = begin + 1; end < order.size() && keys[order[end]] == key;) ++end;
    if (end == begin + 1) {
      kept.push_back(order[begin]);
      continue;
    }
    items.assign(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end));
    keepSome(items, pool, static_cast<std::size_t>(params.keep));
    kept.insert(kept.end(), items.begin(), items.end());
  }
  return kept;
}

template <typename T>
std::vector<T> pick(const std::vector<T>& values, const std::vector<std::uint32_t>& which) {
  std::vector<T> picked(values.empty() ? 0 : which.size());
  for (std::size_t i = 0; i < picked.size(); ++i) picked[i] = values[which[i]];
  return picked;
}

TilePoints thinPool(const TileKey& key, std::vector<scan::ScanId> scans, const Pool& pool, const ThinParams& params) {
  const auto kept = keptOf(pool, params);
  return {key,
          std::move(scans),
          pick(pool.x, kept),
          pick(pool.y, kept),
          pick(pool.z, kept),
          pick(pool.intensity, kept),
          pick(pool.scan, kept),
          pick(pool.point, kept),
          pick(pool.rank, kept)};
}

/// Appends a part's coordinates; intensity is filled with 0 where a part has none and another has.
template <typename Part>
void appendCoordinates(Pool& pool, const Part& part, bool with_intensity) {
  pool.x.insert(pool.x.end(), part.x.begin(), part.x.end());
  pool.y.insert(pool.y.end(), part.y.begin(), part.y.end());
  pool.z.insert(pool.z.end(), part.z.begin(), part.z.end());
  pool.point.insert(pool.point.end(), part.point.begin(), part.point.end());
  pool.rank.insert(pool.rank.end(), part.rank.begin(), part.rank.end());
  if (!with_intensity) return;
  pool.intensity.insert(pool.intensity.end(), part.intensity.begin(), part.intensity.end());
  pool.intensity.resize(pool.x.size(), 0.0F);
}

std::vector<scan::ScanId> sortedUnique(std::vector<scan::ScanId> scans) {
  std::sort(scans.begin(), scans.end());
  scans.erase(std::unique(scans.begin(), scans.end()), scans.end());
  return scans;
}

std::uint32_t placeOf(const std::vector<scan::ScanId>& scans, const scan::ScanId& scan) {
  return static_cast<std::uint32_t>(std::lower_bound(scans.begin(), scans.end(), scan) - scans.begin());
}

Error strayPoint(const scan::Scan& scan, std::uint32_t point) {
  return Error(ErrorKind::StoreUnavailable, "a tile names point " + std::to_string(point) + " of scan " +
                                                scan.id.hex() +
                                                ", which is not there; the map is damaged, build it anew");
}

/// The corner of a tile in the frame of the grid.
Eigen::Vector3d cornerInGrid(const TileKey& key) {
  return TileGrid().cornerOf(key);
}

/// As floats relative to a tile's corner; both in the frame of the grid.
Eigen::Vector3f relativeTo(const Eigen::Vector3d& corner, const Eigen::Vector3d& p_grid, const TileGrid& grid) {
  const Eigen::Vector3d p = p_grid - corner;
  // Just below the upper edge, rounding could give the edge itself, which belongs to the next tile.
  static constexpr auto kLastStep = static_cast<std::int64_t>(kTileSize_m / kLocalStep_m) - 1;
  const auto rounded = [](double value_m) {
    return static_cast<float>(static_cast<double>(std::min(fastFloor(value_m / kLocalStep_m), kLastStep)) *
                              kLocalStep_m);
  };
  return {rounded(p.x()), rounded(p.y()), grid.roundsHeights() ? toHeightStep(p.z()) : static_cast<float>(p.z())};
}

/// Whether tileOf() gives the tile with this corner. Corners in the grid and the tile size are exact.
bool liesAt(const Eigen::Vector3d& corner, const Eigen::Vector3d& p_grid) {
  return p_grid.x() >= corner.x() && p_grid.x() < corner.x() + kTileSize_m && p_grid.y() >= corner.y() &&
         p_grid.y() < corner.y() + kTileSize_m;
}

}  // namespace

void describe(ThinParams& params, ParameterVisitor& visitor) {
  visitor.real(
      {"thin.voxel", "m", 0.01, 0.5,
       "width of the voxels in which points are thinned; they are as high, rounded so that 16 m hold a whole number"},
      params.voxel_m);
  visitor.whole({"thin.keep", "1", 1, 1000, "points kept in each voxel"}, params.keep);
}

Eigen::Vector3f localPoint(const TileGrid& grid, const TileKey& key, const Eigen::Vector3d& p_map) {
  return relativeTo(cornerInGrid(key), grid.fromMap(p_map), grid);
}

std::map<TileKey, ScanSegment> splitScan(const scan::Scan& scan, const TileGrid& grid) {
  std::map<TileKey, ScanSegment> segments;
  ScanSegment* segment = nullptr;
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  // of the segment's tile
  const auto& points = scan.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p_map = scan::toMap(scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
    if (!scan::isInMapRange(p_map)) scan::refusePointOutOfRange(scan, i);
    const Eigen::Vector3d p_grid = grid.fromMap(p_map);
    if (segment == nullptr || !liesAt(corner, p_grid)) {
      const TileKey key = TileGrid().tileOf(p_grid);
      corner = cornerInGrid(key);
      segment = &segments[key];
      segment->key = key;
      segment->scan = scan.id;
    }
    const Eigen::Vector3f p = relativeTo(corner, p_grid, grid);
    segment->x.push_back(p.x());
    segment->y.push_back(p.y());
    segment->z.push_back(p.z());
    if (!points.intensity.empty()) segment->intensity.push_back(points.intensity[i]);
    segment->point.push_back(static_cast<std::uint32_t>(i));
    segment->rank.push_back(rankOf(points, i));
  }
  for (auto& [key, grown] : segments) {  // many scans wait for the first stage
    for (auto* values : {&grown.x, &grown.y, &grown.z, &grown.intensity}) values->shrink_to_fit();
    for (auto* values : {&grown.point, &grown.rank}) values->shrink_to_fit();
  }
  return segments;
}

TilePoints thin(const TileKey& key, std::span<const ScanSegment* const> segments, const ThinParams& params) {
  std::vector<const ScanSegment*> sorted(segments.begin(), segments.end());
  std::sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->scan < b->scan; });
  const bool with_intensity = std::any_of(sorted.begin(), sorted.end(), [](auto* s) { return !s->intensity.empty(); });
  Pool pool;
  std::vector<scan::ScanId> scans;
  for (const auto* segment : sorted) {
    if (segment->size() == 0) continue;
    if (scans.empty() || scans.back() != segment->scan) scans.push_back(segment->scan);
    appendCoordinates(pool, *segment, with_intensity);
    pool.scan.resize(pool.x.size(), static_cast<std::uint32_t>(scans.size() - 1));
  }
  return thinPool(key, std::move(scans), pool, params);
}

TilePoints thin(const TileKey& key, std::span<const TilePoints* const> parts, const ThinParams& params) {
  std::vector<scan::ScanId> scans;
  bool with_intensity = false;
  for (const auto* part : parts) {
    scans.insert(scans.end(), part->scans.begin(), part->scans.end());
    with_intensity = with_intensity || !part->intensity.empty();
  }
  scans = sortedUnique(std::move(scans));
  Pool pool;
  for (const auto* part : parts) {
    appendCoordinates(pool, *part, with_intensity);
    for (const auto scan : part->scan) pool.scan.push_back(placeOf(scans, part->scans[scan]));
  }
  return thinPool(key, std::move(scans), pool, params);
}

void PointsFromScans::add(TilePoints& tile) {
  std::vector<Part> parts(tile.scans.size(), Part{&tile, {}});
  for (std::uint32_t i = 0; i < tile.size(); ++i) parts[tile.scan[i]].points.push_back(i);
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (!parts[k].points.empty()) parts_[tile.scans[k]].push_back(std::move(parts[k]));
}

std::vector<scan::ScanId> PointsFromScans::scans() const {
  std::vector<scan::ScanId> ids;
  for (const auto& [id, parts] : parts_) ids.push_back(id);
  return ids;
}

void PointsFromScans::fill(const scan::Scan& scan) const {
  const scan::ScanPoints& points = scan.points;
  const auto found = parts_.find(scan.id);
  if (found == parts_.end()) return;
  for (const auto& [tile, own] : found->second) {
    const Eigen::Vector3d corner = cornerInGrid(tile->key);
    for (const std::uint32_t i : own) {
      const std::uint32_t at = tile->point[i];
      if (at >= points.size()) throw strayPoint(scan, at);
      const Eigen::Vector3d p_map = scan::toMap(scan.T_map_sensor, {points.x[at], points.y[at], points.z[at]});
      const Eigen::Vector3d p_grid = grid_.fromMap(p_map);
      if (!liesAt(corner, p_grid) || !scan::isInMapRange(p_map)) throw strayPoint(scan, at);
      const Eigen::Vector3f p = relativeTo(corner, p_grid, grid_);
      tile->x[i] = p.x(), tile->y[i] = p.y(), tile->z[i] = p.z();
      if (!tile->intensity.empty()) tile->intensity[i] = points.intensity.empty() ? 0.0F : points.intensity[at];
      tile->rank[i] = rankOf(points, at);
    }
  }
}

RepresentativeFinder::RepresentativeFinder(const TilePoints& points, const ThinParams& params, const TileGrid& grid)
    : points_(points), voxel_m_(params.voxel_m), whole_layers_(grid.roundsHeights()), voxel_(points.size()) {
  const VoxelKeys voxel(voxel_m_, whole_layers_);
  for (std::size_t i = 0; i < points.size(); ++i) voxel_[i] = voxel(points.x[i], points.y[i], points.z[i]);
}

std::uint32_t RepresentativeFinder::find(const Eigen::Vector3f& p_local) const {
  const auto [begin, end] = std::equal_range(voxel_.begin(), voxel_.end(),
                                             VoxelKeys(voxel_m_, whole_layers_)(p_local.x(), p_local.y(), p_local.z()));
  std::uint32_t nearest = kNone;
  float nearest_squared = 0;
  for (auto at = begin; at != end; ++at) {
    const auto i = static_cast<std::uint32_t>(at - voxel_.begin());
    const float squared = (points_.at(i) - p_local).squaredNorm();
    if (nearest != kNone && squared >= nearest_squared) continue;
    nearest = i;
    nearest_squared = squared;
  }
  return nearest;
}

}  // namespace cluxel::perception
