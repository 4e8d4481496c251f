// SPDX-License-Identifier: Apache-2.0
// The ground surface on generated terrain, and against the labelled ground of real scans where these are available.
#include "perception/features/ground_tile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "cloud_fixture.hpp"
#include "cluxel/error.hpp"
#include "scan/scan_set.hpp"
#include "scan/truth/truth.hpp"
#include "test_paths.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

using testing::CloudMaker;
using testing::scanOf;

struct Ground {
  TileOutputs tiles;
  explicit Ground(const std::vector<Scan>& scans) : tiles(perceive(scans, {}, 1)) {}
  double at(const Eigen::Vector3d& p_map) const {
    const TileKey key = TileGrid().tileOf(p_map);
    const Eigen::Vector3d p = p_map - TileGrid().cornerOf(key);
    return groundHeightAt(ringIn(tiles.ground, key), p.x(), p.y());
  }
};

using Terrain = std::function<double(double x, double y)>;

/// `count` points of a terrain over 40 m x 40 m around the origin.
CloudMaker terrainCloud(const Terrain& height, std::size_t count) {
  CloudMaker maker(21, 0.015);
  maker.surface(count, [&](double u, double v) -> Eigen::Vector3d {
    const double x = 40 * u - 20, y = 40 * v - 20;
    return {x, y, height(x, y)};
  });
  return maker;
}

/// Largest error of the ground over a lattice of positions.
double largestError(const Ground& ground, const Terrain& height) {
  double largest = 0;
  for (double x = -15; x <= 15; x += 0.73)
    for (double y = -15; y <= 15; y += 0.73) largest = std::max(largest, std::abs(ground.at({x, y, 0}) - height(x, y)));
  return largest;
}

double slope(double x, double y) {
  return 0.25 * x + 0.1 * y + 0.4 * std::sin(0.3 * y);
}

TEST(GroundTile, FollowsASlopeUnderCarsHousesAndCrowns) {
  CloudMaker maker = terrainCloud(slope, 80000);
  const auto box = [&](double x, double y, double length, double width, double height) {
    const double z = slope(x, y);
    maker.plane(2500, {x, y, z + height}, {length, 0, 0.25 * length}, {0, width, 0})
        .plane(1200, {x, y, z + 0.3}, {length, 0, 0.25 * length}, {0, 0, height - 0.3})
        .plane(1200, {x, y, z + 0.3}, {0, width, 0}, {0, 0, height - 0.3});
  };
  box(3, 3, 4.2, 1.8, 1.5);
  box(-8, -8, 7, 5, 5);
  maker.ball(4000, {8, -6, slope(8, -6) + 4}, 2).pole(300, {8, -6, slope(8, -6)}, 3, 0.15);
  EXPECT_LT(largestError(Ground({scanOf(maker.points())}), slope), 0.25);
}

TEST(GroundTile, BridgesWhatAHouseHides) {
  const auto hidden = [](double x, double y) { return x > 1 && x < 11 && y > -12 && y < -4; };
  CloudMaker maker(22, 0.015);
  const CloudMaker open = terrainCloud(slope, 80000);
  std::vector<Eigen::Vector3d> points;
  for (const auto& p : open.points())
    if (!hidden(p.x(), p.y())) points.push_back(p);
  maker.plane(8000, {1, -12, slope(6, -8) + 6}, {10, 0, 0}, {0, 8, 0});  // its flat roof
  points.insert(points.end(), maker.points().begin(), maker.points().end());
  EXPECT_LT(largestError(Ground({scanOf(points)}), slope), 0.6);
}

TEST(GroundTile, IgnoresReflectionsFromUnderTheGround) {
  CloudMaker maker = terrainCloud(slope, 80000);
  maker.ball(12, {4, 4, slope(4, 4) - 2.5}, 0.3).ball(3, {-6, 7, slope(-6, 7) - 6}, 0.2);
  EXPECT_LT(largestError(Ground({scanOf(maker.points())}), slope), 0.25);
}

TEST(GroundTile, GivesEveryPointOfASparseCloudAFiniteHeight) {
  CloudMaker maker(23);
  maker.ball(60, {0, 0, 5}, 30);
  const Ground ground({scanOf(maker.points())});
  for (const auto& p : maker.points()) EXPECT_TRUE(std::isfinite(ground.at(p)));
  EXPECT_TRUE(std::isfinite(Ground({scanOf({{1, 2, 3}})}).at({1, 2, 3})));
  EXPECT_NEAR(Ground({scanOf({{1, 2, 3}})}).at({1, 2, 3}), 3, 1e-6);
}

TEST(GroundTile, AgreesAtABorderWhicheverTileIsAsked) {
  const CloudMaker maker = terrainCloud(slope, 30000);
  const Ground ground({scanOf(maker.points())});
  for (double y = -14; y < 14; y += 0.37) {
    const TileKey left = TileGrid().tileOf({-0.01, y, 0}), right = TileGrid().tileOf({0.01, y, 0});
    const double local_y = y - TileGrid().cornerOf(left).y();
    EXPECT_NEAR(groundHeightAt(ringIn(ground.tiles.ground, left), kTileSize_m, local_y),
                groundHeightAt(ringIn(ground.tiles.ground, right), 0.0, local_y), 1e-9);
  }
}

TEST(GroundTile, BytesComeBackAndDamagedOnesAreRefused) {
  const Ground ground({scanOf(terrainCloud(slope, 5000).points())});
  const std::string bytes = toBytes(ground.tiles.ground.begin()->second);
  EXPECT_EQ(toBytes(groundTileFromBytes(bytes)), bytes);
  for (std::size_t size = 0; size < bytes.size(); size += 61)
    EXPECT_THROW(groundTileFromBytes(bytes.substr(0, size)), Error);
}

/// Distances of labelled ground points from the ground surface [m], sorted by size.
std::vector<double> errorsOnGroundPoints(const std::vector<Scan>& scans, const std::filesystem::path& labels) {
  const LabelMap map = LabelMap::load(labels);
  const Ground ground(scans);
  std::vector<double> errors;
  for (const auto& scan : scans) {
    const PointTruth truth = truthFromLabels(scan, map);
    for (std::size_t i = 0; i < scan.points.size(); i += 5) {
      if (truth.primitive[i] != static_cast<std::int8_t>(PrimitiveLabel::HorizontalPlane)) continue;
      const Eigen::Vector3d p = toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
      errors.push_back(std::abs(p.z() - ground.at(p)));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

void expectGroundIsNear(const std::filesystem::path& scans_path, const std::string& labels, std::size_t scan_count,
                        double median_m, double max_m) {
  if (!std::filesystem::exists(scans_path)) GTEST_SKIP() << "outside data absent: " << scans_path;
  ProgressSink sink;
  const ScanSet set = ScanSet::open({scans_path}, {}, sink);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < std::min(scan_count, set.size()); ++i) scans.push_back(set.load(i));
  const auto errors = errorsOnGroundPoints(scans, test::sourceFolder() / labels);
  ASSERT_GT(errors.size(), 1000U);
  const auto share = [&](double part) {
    return errors[static_cast<std::size_t>(part * static_cast<double>(errors.size() - 1))];
  };
  ::testing::Test::RecordProperty("median_m", std::to_string(share(0.5)));
  ::testing::Test::RecordProperty("p95_m", std::to_string(share(0.95)));
  EXPECT_LT(share(0.5), median_m) << "90 %: " << share(0.9) << ", 95 %: " << share(0.95) << ", 99 %: " << share(0.99);
  EXPECT_LT(share(0.95), max_m) << "median: " << share(0.5) << ", 99 %: " << share(0.99);
}

TEST(GroundTile, LiesOnTheLabelledGroundOfOakland) {
  expectGroundIsNear(test::outsideDataFolder() / "oakland3d", "labels/oakland.yaml", 10, 0.05, 0.25);
}

TEST(GroundTile, LiesOnTheLabelledGroundOfKitti) {
  expectGroundIsNear(test::outsideDataFolder() / "kitti00", "labels/semantickitti.yaml", 3, 0.06, 0.35);
}

}  // namespace
}  // namespace cluxel::perception
