// SPDX-License-Identifier: Apache-2.0
// Seeded points on simple surfaces.
#include "cloud_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::testing {

using namespace scan;
using namespace perception;

void CloudMaker::add(const Eigen::Vector3d& point) {
  std::normal_distribution<double> noise(0, noise_m_);
  const double x = noise(random_), y = noise(random_), z = noise(random_);
  points_.push_back(point + Eigen::Vector3d(x, y, z));
}

CloudMaker& CloudMaker::surface(std::size_t count, const std::function<Eigen::Vector3d(double, double)>& at) {
  for (std::size_t i = 0; i < count; ++i) {
    const double u = unit(), v = unit();
    add(at(u, v));
  }
  return *this;
}

CloudMaker& CloudMaker::plane(std::size_t count, const Eigen::Vector3d& corner, const Eigen::Vector3d& a,
                              const Eigen::Vector3d& b) {
  return surface(count, [&](double u, double v) -> Eigen::Vector3d { return corner + u * a + v * b; });
}

CloudMaker& CloudMaker::pole(std::size_t count, const Eigen::Vector3d& foot, double height_m, double radius_m) {
  return surface(count, [&](double u, double v) -> Eigen::Vector3d {
    const double angle = 2 * std::numbers::pi * u;
    return foot + Eigen::Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle), height_m * v);
  });
}

CloudMaker& CloudMaker::ball(std::size_t count, const Eigen::Vector3d& centre, double radius_m) {
  for (std::size_t i = 0; i < count;) {
    const double x = 2 * unit() - 1, y = 2 * unit() - 1, z = 2 * unit() - 1;
    if (x * x + y * y + z * z > 1) continue;
    add(centre + radius_m * Eigen::Vector3d(x, y, z));
    ++i;
  }
  return *this;
}

Scan scanOf(const std::vector<Eigen::Vector3d>& points) {
  Scan scan;
  for (const auto& p : points) {
    scan.points.x.push_back(static_cast<float>(p.x()));
    scan.points.y.push_back(static_cast<float>(p.y()));
    scan.points.z.push_back(static_cast<float>(p.z()));
  }
  scan.source = "generated";
  scan.id = contentIdOf(scan);
  return scan;
}

std::vector<Eigen::Vector3d> streetPoints(std::uint32_t seed) {
  CloudMaker maker(seed);
  maker.plane(9000, {-9, -9, 0}, {20, 0, 1.2}, {0, 18, 0.3})
      .plane(3000, {-8, 4, 0.3}, {17, 0, 1}, {0, 0, 4})
      .pole(400, {0.02, -0.03, 0.6}, 4, 0.08)
      .pole(400, {-4, 1, 0.5}, 3, 0.15)
      .ball(1500, {-4, 1, 4.5}, 1.2);
  return maker.points();
}

std::vector<Scan> splitAtRandom(const std::vector<Eigen::Vector3d>& points, std::size_t scans, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::vector<Eigen::Vector3d>> parts(scans);
  for (const auto& p : points) parts[std::uniform_int_distribution<std::size_t>(0, scans - 1)(random)].push_back(p);
  std::vector<Scan> made;
  for (const auto& part : parts) made.push_back(scanOf(part));
  return made;
}

std::map<TileKey, TilePoints> tilesOf(const std::vector<Scan>& scans, const ThinParams& params) {
  std::map<TileKey, std::vector<ScanSegment>> segments;
  for (const auto& scan : scans)
    for (auto& [key, segment] : splitScan(scan, {})) segments[key].push_back(segment);
  std::map<TileKey, TilePoints> tiles;
  for (const auto& [key, parts] : segments) {
    std::vector<const ScanSegment*> pointers;
    for (const auto& part : parts) pointers.push_back(&part);
    tiles[key] = thin(key, pointers, params);
  }
  return tiles;
}

std::string bytesOf(const TileOutputs& tiles) {
  std::string bytes;
  for (const auto& [key, tile] : tiles.points) bytes += toBytes(tile);
  for (const auto& [key, tile] : tiles.cluxels) bytes += toBytes(tile);
  for (const auto& [key, tile] : tiles.ground) bytes += toBytes(tile);
  for (const auto& [key, tile] : tiles.features) bytes += toBytes(tile);
  return bytes;
}

std::vector<double> meanFeatures(const std::vector<Eigen::Vector3d>& points, const PerceptionParams& params,
                                 const Eigen::Vector3d& centre, double within_m) {
  const std::vector<Scan> scans{scanOf(points)};
  const TileOutputs tiles = perceive(scans, params, 1);
  const std::size_t columns = featureLayout(params.features).columns.size();
  std::vector<double> mean(columns);
  std::size_t count = 0;
  for (const auto& [key, tile] : tiles.features)
    for (std::size_t c = 0; c < tile.size(); ++c) {
      if ((tile.center[c].cast<double>() + TileGrid().cornerOf(key) - centre).norm() > within_m) continue;
      ++count;
      for (std::size_t i = 0; i < columns; ++i) mean[i] += tile.features[c * columns + i];
    }
  EXPECT_GT(count, 0U) << "no cluxel near the place";
  for (auto& value : mean) value /= static_cast<double>(count);
  return mean;
}

std::size_t columnOf(const FeatureLayout& layout, const std::string& name) {
  const auto found = std::find(layout.columns.begin(), layout.columns.end(), name);
  EXPECT_NE(found, layout.columns.end()) << name;
  return static_cast<std::size_t>(found - layout.columns.begin());
}

}  // namespace cluxel::testing
