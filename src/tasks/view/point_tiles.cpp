// SPDX-License-Identifier: Apache-2.0
// Sorts points into tiles. Within a level they stand by object and then along a Morton curve, which compresses well.
#include "tasks/view/point_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <tuple>

#include "base/content_hash.hpp"
#include "base/mixed_bits.hpp"
#include "base/packing/zstd_packing.hpp"
#include "mapping/regions/answered_clouds.hpp"

namespace cluxel::tasks {

namespace {

/// One point of a tile before it is written.
struct ViewPoint {
  std::uint16_t x = 0, y = 0;  ///< quanta from the tile's corner
  std::int32_t z = 0;          ///< quanta from the map's zero
  std::uint32_t object = 0;    ///< number + 1, 0: none
  float intensity = 0;
  std::uint16_t cloud = 0;
  std::uint8_t height = 0, label = 0, level = 0;
};

using ViewTileMap = std::map<ViewTileKey, std::vector<ViewPoint>>;

/// Level 0 holds a 64th of the points, level 1 together with it a 16th, level 2 a quarter.
std::uint8_t levelOf(std::uint64_t hash) {
  const std::uint64_t share = hash & 63U;
  if (share == 0) return 0;
  if (share < 4) return 1;
  return share < 16 ? 2 : 3;
}

std::uint8_t heightByte(double height_m) {
  return static_cast<std::uint8_t>(
      std::clamp(std::round((height_m - kLowestHeight_m) / kShownHeightStep_m), 0.0, 255.0));
}

/// Reads one cloud into the tiles.
class CloudReader {
 public:
  CloudReader(const std::vector<mapping::CluxelHeight>& heights, double kept_share, ViewTileMap& tiles)
      : heights_(heights), kept_(static_cast<std::uint64_t>(kept_share * kAll)), tiles_(tiles) {}

  /// `number`: the cloud's place in cloudsByTime().
  void read(const mapping::Cloud& cloud, std::size_t number, const scan::ScanPoints& points,
            const mapping::PointAnswers& answers) {
    const auto cloud_in_page = static_cast<std::uint16_t>(number & 0xffffU);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::uint64_t hash = mixedBits((static_cast<std::uint64_t>(cloud_in_page) << 40U) + i);
      if ((hash >> 32U) >= kept_) continue;
      const Eigen::Vector3d p = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
      ViewPoint point = placed(p);
      point.cloud = cloud_in_page;
      point.level = levelOf(hash);
      point.label = answers.label[i];
      if (answers.object[i] != mapping::kNoObjectOfPoint) point.object = answers.object[i] + 1;
      if (!points.intensity.empty() && std::isfinite(points.intensity[i])) point.intensity = points.intensity[i];
      point.height = heightByte(heightOf(p, answers.cluxel[i]));
      tiles_[key_].push_back(point);
    }
  }

 private:
  static constexpr double kAll = 4294967296.0;  // 2^32

  /// Sets key_.
  ViewPoint placed(const Eigen::Vector3d& p) {
    const Eigen::Vector2d cell = (p.head<2>() / kViewTile_m).array().floor();
    key_ = {static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y())};
    const Eigen::Vector2d within = (p.head<2>() - cell * kViewTile_m) / kViewQuantum_m;
    ViewPoint point;
    point.x = static_cast<std::uint16_t>(std::lround(within.x()));
    point.y = static_cast<std::uint16_t>(std::lround(within.y()));
    point.z = static_cast<std::int32_t>(std::clamp(std::round(p.z() / kViewQuantum_m), -1e9, 1e9));
    return point;
  }

  double heightOf(const Eigen::Vector3d& p, std::uint32_t cluxel) const {
    if (cluxel >= heights_.size()) return 0;
    const auto& [z_m, above_m] = heights_[cluxel];
    return p.z() - static_cast<double>(z_m) + static_cast<double>(above_m);
  }

  const std::vector<mapping::CluxelHeight>& heights_;
  std::uint64_t kept_;
  ViewTileMap& tiles_;
  ViewTileKey key_;
};

/// The values between which 98 of 100 intensities lie: single bright returns would leave everything else dark.
std::array<double, 2> intensityRange(const ViewTileMap& tiles) {
  std::vector<float> sample;
  for (const auto& [key, points] : tiles)
    for (const ViewPoint& point : points)
      if (point.level < 2) sample.push_back(point.intensity);
  if (sample.empty()) return {0, 0};
  std::sort(sample.begin(), sample.end());
  return {sample[sample.size() / 100], sample[sample.size() - 1 - sample.size() / 100]};
}

/// The bits of three numbers of 16 bits in turn.
std::uint64_t mortonCode(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  std::uint64_t code = 0;
  for (unsigned bit = 0; bit < 16; ++bit)
    code |= ((x >> bit & 1U) << (3 * bit)) | ((y >> bit & 1U) << (3 * bit + 1)) | ((z >> bit & 1U) << (3 * bit + 2));
  return code;
}

/// Writes the points of one tile. Points come in the order of clouds and of points in them.
class TileWriter {
 public:
  TileWriter(const ViewTileKey& key, const std::vector<ViewPoint>& points, const std::array<double, 2>& intensity)
      : points_(points), intensity_(intensity) {
    const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                                 [](const ViewPoint& a, const ViewPoint& b) { return a.z < b.z; });
    low_z_ = low->z;
    const double range = static_cast<double>(high->z) - low->z;
    z_step_ = std::max(1.0, std::ceil(range / 65535.0));
    tile_.z_quantum_m = kViewQuantum_m * z_step_;
    tile_.origin = {static_cast<double>(key.first) * kViewTile_m, static_cast<double>(key.second) * kViewTile_m,
                    low_z_ * kViewQuantum_m};
    tile_.size = {kViewTile_m, kViewTile_m, range * kViewQuantum_m};
  }

  PointTile written() {
    const std::vector<std::uint32_t> order = sortedOrder();
    for (const ViewPoint& point : points_) ++tile_.points_to[point.level];
    std::partial_sum(tile_.points_to.begin(), tile_.points_to.end(), tile_.points_to.begin());
    plane(order, 2, [](const ViewPoint& p) { return p.x; });
    plane(order, 2, [](const ViewPoint& p) { return p.y; });
    plane(order, 2, [this](const ViewPoint& p) { return zOf(p); });
    plane(order, 3, [](const ViewPoint& p) { return p.object; });
    plane(order, 2, [](const ViewPoint& p) { return p.cloud; });
    plane(order, 1, [this](const ViewPoint& p) { return intensityByte(p); });
    plane(order, 1, [](const ViewPoint& p) { return p.height; });
    plane(order, 1, [](const ViewPoint& p) { return p.label; });
    return std::move(tile_);
  }

 private:
  std::uint32_t zOf(const ViewPoint& point) const {
    return static_cast<std::uint32_t>(std::floor((static_cast<double>(point.z) - low_z_) / z_step_));
  }

  std::uint32_t intensityByte(const ViewPoint& point) const {
    const double range = intensity_[1] - intensity_[0];
    if (range <= 0) return 0;
    return static_cast<std::uint32_t>(
        std::lround(std::clamp((point.intensity - intensity_[0]) / range, 0.0, 1.0) * 255));
  }

  std::vector<std::uint32_t> sortedOrder() const {
    std::vector<std::uint64_t> code;
    code.reserve(points_.size());
    for (const ViewPoint& point : points_) code.push_back(mortonCode(point.x, point.y, zOf(point)));
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(points_[a].level, points_[a].object, code[a], a) <
             std::tuple(points_[b].level, points_[b].object, code[b], b);
    });
    return order;
  }

  /// Appends the lowest bytes of a number of each point as planes: gzip compresses them better than whole numbers.
  template <typename Value>
  void plane(const std::vector<std::uint32_t>& order, std::size_t bytes_per_value, const Value& value) {
    std::vector<std::uint32_t> values;
    values.reserve(order.size());
    for (const std::uint32_t i : order) values.push_back(value(points_[i]));
    appendPlanes(tile_.planes, values.data(), values.size(), sizeof(std::uint32_t));
    tile_.planes.resize(tile_.planes.size() - values.size() * (sizeof(std::uint32_t) - bytes_per_value));
  }

  const std::vector<ViewPoint>& points_;
  std::array<double, 2> intensity_;
  std::int32_t low_z_ = 0;
  double z_step_ = 1;
  PointTile tile_;
};

}  // namespace

std::vector<mapping::Cloud> cloudsByTime(const mapping::MapReader& map) {
  std::vector<mapping::Cloud> clouds = map.clouds();
  std::sort(clouds.begin(), clouds.end(), [](const mapping::Cloud& a, const mapping::Cloud& b) {
    return std::tie(a.time_s, a.id) < std::tie(b.time_s, b.id);
  });
  return clouds;
}

std::string tileStateOf(const mapping::MapReader& map) {
  ContentHasher hasher;
  for (const mapping::Cloud& cloud : cloudsByTime(map)) {
    const Eigen::Matrix4d pose = cloud.T_map_sensor.matrix();
    hasher.add(cloud.id).addBytes(pose.data(), sizeof(double) * 16);
  }
  for (const ContentHash& object : map.objectIds()) hasher.add(object);
  return hasher.finish().hex();
}

/// The points of a cloud, which the first who wants them reads.
struct PointTileSource::CloudPoints {
  std::mutex mutex;
  std::optional<ViewTileMap> tiles;
};

/// A cloud that is given up here stays for those who are using it.
struct PointTileSource::Kept {
  std::mutex mutex;
  std::map<std::size_t, std::shared_ptr<CloudPoints>> clouds;
  std::deque<std::size_t> order;  ///< of clouds, the longest kept first
  std::uint64_t points = 0;
  std::once_flag has_heights;
  std::vector<mapping::CluxelHeight> heights;
  std::mutex answers_mutex;
  std::optional<mapping::KeptAnswers> answers;

  const std::vector<mapping::CluxelHeight>& heightsIn(const mapping::MapReader& map) {
    std::call_once(has_heights, [&] { heights = mapping::heightsOfCluxels(map); });
    return heights;
  }

  mapping::PointAnswers answersIn(const mapping::MapReader& map, const mapping::Cloud& cloud,
                                  const scan::ScanPoints& points_of_cloud) {
    const std::lock_guard lock(answers_mutex);
    if (!answers || !answers->isOf(map)) answers.emplace(map);
    return answers->answersFor(map, cloud, points_of_cloud);
  }

  ViewTileMap tilesOf(const mapping::MapReader& map, const mapping::Cloud& cloud, std::size_t number) {
    const scan::ScanPoints of_cloud = map.pointsOf(cloud.id);
    ViewTileMap tiles;
    CloudReader(heightsIn(map), 1.0, tiles).read(cloud, number, of_cloud, answersIn(map, cloud, of_cloud));
    return tiles;
  }
};

PointTileSource::PointTileSource(const mapping::MapReader& map)
    : state_(tileStateOf(map)), clouds_(cloudsByTime(map)), kept_(std::make_unique<Kept>()) {}
PointTileSource::~PointTileSource() = default;
PointTileSource::PointTileSource(PointTileSource&&) noexcept = default;

std::shared_ptr<PointTileSource::CloudPoints> PointTileSource::placeOf(std::size_t cloud) const {
  constexpr std::uint64_t most_kept = 4'000'000;  // points of some 24 bytes
  const std::lock_guard lock(kept_->mutex);
  if (const auto found = kept_->clouds.find(cloud); found != kept_->clouds.end()) return found->second;
  while (!kept_->order.empty() && kept_->points + clouds_[cloud].point_count > most_kept) {
    kept_->points -= clouds_[kept_->order.front()].point_count;
    kept_->clouds.erase(kept_->order.front());
    kept_->order.pop_front();
  }
  kept_->points += clouds_[cloud].point_count;
  kept_->order.push_back(cloud);
  return kept_->clouds[cloud] = std::make_shared<CloudPoints>();
}

std::optional<PointTile> PointTileSource::tile(const mapping::MapReader& map, const ViewTileKey& key,
                                               const std::array<double, 2>& intensity) const {
  const double x = static_cast<double>(key.first) * kViewTile_m, y = static_cast<double>(key.second) * kViewTile_m;
  std::vector<ViewPoint> points;
  for (std::size_t i = 0; i < clouds_.size(); ++i) {
    const mapping::Cloud& cloud = clouds_[i];
    if (cloud.max.x() < x || cloud.min.x() > x + kViewTile_m || cloud.max.y() < y || cloud.min.y() > y + kViewTile_m)
      continue;
    const std::shared_ptr<CloudPoints> cloud_points = placeOf(i);
    const std::lock_guard lock(cloud_points->mutex);
    if (!cloud_points->tiles) cloud_points->tiles = kept_->tilesOf(map, cloud, i);
    const ViewTileMap& of_cloud = *cloud_points->tiles;
    if (const auto found = of_cloud.find(key); found != of_cloud.end())
      points.insert(points.end(), found->second.begin(), found->second.end());
  }
  if (points.empty()) return std::nullopt;
  return TileWriter(key, points, intensity).written();
}

std::string tileBytes(const PointTile& tile) {
  const nlohmann::ordered_json head{{"origin", {tile.origin.x(), tile.origin.y(), tile.origin.z()}},
                                    {"size", {tile.size.x(), tile.size.y(), tile.size.z()}},
                                    {"zQuantum", tile.z_quantum_m},
                                    {"pointsTo", tile.points_to}};
  return head.dump() + "\n" + tile.planes;
}

PointTiles pointTilesOf(const mapping::MapReader& map, std::uint64_t max_points) {
  const std::vector<mapping::Cloud> clouds = cloudsByTime(map);
  PointTiles result;
  for (const mapping::Cloud& cloud : clouds) result.points_in_map += cloud.point_count;
  const double share = result.points_in_map <= max_points
                           ? 1.0
                           : static_cast<double>(max_points) / static_cast<double>(result.points_in_map);
  ViewTileMap tiles;
  const std::vector<mapping::CluxelHeight> heights = mapping::heightsOfCluxels(map);
  CloudReader reader(heights, share, tiles);
  std::size_t number = 0;
  mapping::forEachAnsweredCloud(
      map, clouds,
      [&](const mapping::Cloud& cloud, const scan::ScanPoints& points, const mapping::PointAnswers& answers) {
        reader.read(cloud, number++, points, answers);
      });
  result.intensity = intensityRange(tiles);
  for (auto& [key, points] : tiles) {
    result.points += points.size();
    result.tiles.push_back(TileWriter(key, points, result.intensity).written());
    std::vector<ViewPoint>().swap(points);
  }
  return result;
}

}  // namespace cluxel::tasks
