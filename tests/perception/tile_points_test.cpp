// SPDX-License-Identifier: Apache-2.0
// Points of tiles: thinning is independent of arrival order, and every point has a representative.
#include "perception/clustering/tile_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "cloud_fixture.hpp"
#include "cluxel/error.hpp"
#include "perception/clustering/local_steps.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

using testing::CloudMaker;
using testing::scanOf;
using testing::splitAtRandom;
using testing::streetPoints;
using testing::tilesOf;

std::string bytesOf(const std::map<TileKey, TilePoints>& tiles) {
  std::string bytes;
  for (const auto& [key, tile] : tiles) bytes += toBytes(tile);
  return bytes;
}

/// A dense cloud, so that thinning removes points.
std::vector<Scan> crowdedScans(std::uint32_t seed) {
  return splitAtRandom(CloudMaker(seed).plane(20000, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0.2}).points(), 5, seed);
}

/// The bytes of a tile that was read from `bytes` and filled from the scans.
std::string filled(const std::string& bytes, const std::vector<Scan>& scans) {
  TilePoints tile = tilePointsFromBytes(bytes);
  PointsFromScans from_scans({});
  from_scans.add(tile);
  for (const Scan& scan : scans) from_scans.fill(scan);
  return toBytes(tile);
}

TEST(TilePoints, EveryPointOfAScanLiesInExactlyOneSegmentAndNearItsMapPlace) {
  Scan scan = scanOf(streetPoints(1));
  scan.T_map_sensor.translate(Eigen::Vector3d(1000.3, -2000.7, 50));
  scan.T_map_sensor.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1).normalized()));
  std::vector<int> seen(scan.points.size());
  for (const auto& [key, segment] : splitScan(scan, {}))
    for (std::size_t i = 0; i < segment.size(); ++i) {
      const std::uint32_t point = segment.point[i];
      ++seen[point];
      const Eigen::Vector3d p_map =
          toMap(scan.T_map_sensor, {scan.points.x[point], scan.points.y[point], scan.points.z[point]});
      const Eigen::Vector3d back = TileGrid().cornerOf(key) + Eigen::Vector3d(segment.x[i], segment.y[i], segment.z[i]);
      EXPECT_LT((p_map - back).head<2>().norm(), 1e-5);
      EXPECT_LE(std::abs(p_map.z() - back.z()), kHeightStep_m / 2);
      EXPECT_EQ(back.z(), kHeightStep_m * std::round(back.z() / kHeightStep_m));
      EXPECT_TRUE(segment.x[i] >= 0 && segment.x[i] < 16 && segment.y[i] >= 0 && segment.y[i] < 16);
    }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int count) { return count == 1; }));
}

TEST(TilePoints, ThinnedHigherByWholeTilesAreTheSame) {
  for (const double voxel_m : {0.05, 0.07, 0.3}) {
    const auto there = tilesOf({scanOf(streetPoints(3))}, {.voxel_m = voxel_m});
    for (const double rise_m : {16.0, -48.0, 3008.0}) {
      Scan scan = scanOf(streetPoints(3));
      scan.T_map_sensor.pretranslate(Eigen::Vector3d(0, 0, rise_m));
      const auto here = tilesOf({scan}, {.voxel_m = voxel_m});
      ASSERT_EQ(here.size(), there.size());
      for (const auto& [key, points] : here) EXPECT_EQ(points.point, there.at(key).point) << voxel_m << ' ' << rise_m;
    }
  }
}

TEST(TilePoints, OfAnEarlierMapHaveHeightsAsMeasured) {
  const Scan scan = scanOf(streetPoints(1));
  const TileGrid grid = TileGrid().withHeightsAsMeasured();
  std::size_t between_steps = 0;
  for (const auto& [key, segment] : splitScan(scan, grid)) {
    TilePoints tile = tilePointsFromBytes(toBytes(thin(key, std::array{&segment}, {})));
    PointsFromScans from_scans(grid);
    from_scans.add(tile);
    from_scans.fill(scan);
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const float z = scan.points.z[tile.point[i]];
      EXPECT_EQ(tile.z[i], z);
      between_steps += z / kHeightStep_m != std::round(z / kHeightStep_m) ? 1 : 0;
    }
    for (std::size_t i = 0; i < segment.size(); ++i) {
      const std::uint32_t point = segment.point[i];
      const Eigen::Vector3d p =
          toMap(scan.T_map_sensor, {scan.points.x[point], scan.points.y[point], scan.points.z[point]});
      EXPECT_EQ(localPoint(grid, key, p), Eigen::Vector3f(segment.x[i], segment.y[i], segment.z[i]));
    }
  }
  EXPECT_GT(between_steps, 100U);
}

/// Relative to the corner at -16 m they round to the tile's upper edge, though they belong to that tile.
TEST(TilePoints, PointsJustBelowZeroStayInTheirTile) {
  Scan scan = scanOf({{-1e-20F, -1e-20F, 0.5F},
                      {-1e-20F, 3.0F, 0.5F},
                      {-4e-17F, -5.0F, 0.5F},
                      {0.0F, 0.0F, 0.5F},
                      {-1e-6F, -1e-6F, 0.5F}});
  std::size_t points = 0;
  for (const auto& [key, segment] : splitScan(scan, {})) {
    points += segment.size();
    EXPECT_EQ(filled(toBytes(thin(key, std::array{&segment}, {})), {scan}),
              toBytes(thin(key, std::array{&segment}, {})))
        << key.x << ' ' << key.y;
    for (std::size_t i = 0; i < segment.size(); ++i) {
      EXPECT_LT(segment.x[i], static_cast<float>(kTileSize_m));
      EXPECT_LT(segment.y[i], static_cast<float>(kTileSize_m));
    }
  }
  EXPECT_EQ(points, scan.points.size());
}

TEST(TilePoints, RefusesAPointThatIsNoNumberNamingIt) {
  Scan scan = scanOf({{0, 0, 0}, {1, 2, 3}});
  scan.points.y[1] = std::numeric_limits<float>::quiet_NaN();
  try {
    splitScan(scan, {});
    FAIL() << "took a NaN";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("point 1"), std::string::npos) << error.what();
  }
}

TEST(TilePoints, RefusesAPoseThatThrowsPointsOutOfTheMap) {
  Scan scan = scanOf({{0, 0, 0}});
  scan.T_map_sensor.translate(Eigen::Vector3d(1e9, 0, 0));
  EXPECT_THROW(splitScan(scan, {}), InputError);
}

TEST(TilePoints, OrderOfScansDoesNotMatter) {
  auto scans = crowdedScans(2);
  const std::string first = bytesOf(tilesOf(scans, {}));
  std::mt19937 random(3);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(scans.begin(), scans.end(), random);
    EXPECT_EQ(bytesOf(tilesOf(scans, {})), first);
  }
}

TEST(TilePoints, ThinningThinnedPartsEqualsThinningAllAtOnce) {
  for (const int keep : {1, 2, 5}) {
    const ThinParams params{.voxel_m = 0.05, .keep = keep};
    const auto scans = crowdedScans(4);
    const auto all = tilesOf(scans, params);
    const auto part_a = tilesOf({scans[0], scans[3]}, params), part_b = tilesOf({scans[1], scans[2], scans[4]}, params);
    for (const auto& [key, whole] : all) {
      std::vector<const TilePoints*> parts;
      if (part_a.contains(key)) parts.push_back(&part_a.at(key));
      if (part_b.contains(key)) parts.push_back(&part_b.at(key));
      EXPECT_EQ(toBytes(thin(key, parts, params)), toBytes(whole));
      std::reverse(parts.begin(), parts.end());
      EXPECT_EQ(toBytes(thin(key, parts, params)), toBytes(whole));
    }
  }
}

TEST(TilePoints, KeepsNoMoreThanAskedForPerVoxelAndEmptiesNone) {
  const auto scans = crowdedScans(5);
  const auto thinned = tilesOf(scans, {.voxel_m = 0.1, .keep = 3}),
             whole = tilesOf(scans, {.voxel_m = 0.1, .keep = 1000});
  const auto voxelCounts = [](const TilePoints& tile) {
    std::map<std::array<int, 3>, int> counts;
    for (std::size_t i = 0; i < tile.size(); ++i)
      ++counts[{static_cast<int>(std::floor(tile.x[i] / 0.1)), static_cast<int>(std::floor(tile.y[i] / 0.1)),
                static_cast<int>(std::floor((tile.z[i] + kMaxHeight_m + 1) / 0.1))}];
    return counts;
  };
  bool thinned_some = false;
  for (const auto& [key, tile] : whole) {
    const auto before = voxelCounts(tile), after = voxelCounts(thinned.at(key));
    ASSERT_EQ(before.size(), after.size());
    for (const auto& [voxel, count] : before) {
      EXPECT_EQ(after.at(voxel), std::min(count, 3));
      thinned_some = thinned_some || count > 3;
    }
  }
  EXPECT_TRUE(thinned_some);
}

TEST(TilePoints, EveryPointFindsARepresentativeAndAKeptPointFindsItself) {
  const auto scans = crowdedScans(6);
  const ThinParams params{.voxel_m = 0.05, .keep = 1};
  const auto tiles = tilesOf(scans, params);
  for (const auto& scan : scans)
    for (const auto& [key, segment] : splitScan(scan, {})) {
      const TilePoints& tile = tiles.at(key);
      const RepresentativeFinder finder(tile, params);
      for (std::size_t i = 0; i < segment.size(); ++i) {
        const Eigen::Vector3f p(segment.x[i], segment.y[i], segment.z[i]);
        const std::uint32_t found = finder.find(p);
        ASSERT_NE(found, RepresentativeFinder::kNone);
        EXPECT_LT((tile.at(found) - p).norm(), 0.05 * std::sqrt(3.0));
      }
      for (std::uint32_t i = 0; i < tile.size(); ++i) EXPECT_EQ(tile.at(finder.find(tile.at(i))), tile.at(i));
      EXPECT_EQ(finder.find({3, 3, 500}), RepresentativeFinder::kNone);
    }
}

TEST(TilePoints, ComeBackFromTheirScansBitForBit) {
  auto scans = crowdedScans(7);
  scans[1].T_map_sensor.translate(Eigen::Vector3d(0.3, -0.7, 5));
  scans[1].T_map_sensor.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1).normalized()));
  for (const bool with_intensity : {false, true}) {
    if (with_intensity) scans[2].points.intensity.assign(scans[2].points.size(), 0.7F);
    for (Scan& scan : scans) scan.id = contentIdOf(scan);
    for (const auto& [key, tile] : tilesOf(scans, {})) {
      const std::string bytes = toBytes(tile);
      EXPECT_EQ(filled(bytes, scans), bytes);
      EXPECT_NE(filled(bytes, {scans[0], scans[1]}), bytes) << "the others are missing";
    }
  }
}

TEST(TilePoints, OfOtherScansThanTheyNameAreRefused) {
  auto scans = crowdedScans(7);
  const std::string bytes = toBytes(tilesOf(scans, {}).begin()->second);
  Scan moved = scans[0], shorter = scans[0];
  moved.T_map_sensor.translate(Eigen::Vector3d(16, 0, 0));
  EXPECT_THROW(filled(bytes, {moved}), Error);
  for (auto* values : {&shorter.points.x, &shorter.points.y, &shorter.points.z}) values->resize(1);
  EXPECT_THROW(filled(bytes, {shorter}), Error);
  moved.T_map_sensor.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(filled(bytes, {moved}), Error);
}

TEST(TilePoints, DamagedBytesAreRefused) {
  const auto tiles = tilesOf(crowdedScans(7), {});
  const std::string bytes = toBytes(tiles.begin()->second);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97)
    EXPECT_THROW(tilePointsFromBytes(bytes.substr(0, size)), Error);
  EXPECT_THROW(tilePointsFromBytes(bytes + "x"), Error);
}

TEST(TilePoints, AChangedCoordinateChangesTheBytesThoughItIsNotStored) {
  const auto tiles = tilesOf(crowdedScans(7), {});
  TilePoints tile = tiles.begin()->second;
  const std::string bytes = toBytes(tile);
  tile.z[3] = std::nextafter(tile.z[3], 100.0F);
  EXPECT_NE(toBytes(tile), bytes);
  EXPECT_EQ(toBytes(tile).size(), bytes.size());
}

}  // namespace
}  // namespace cluxel::perception
