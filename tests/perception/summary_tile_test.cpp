// SPDX-License-Identifier: Apache-2.0
// Summaries against sums over the points, and even ground that does not depend on how tiles cut it.
#include "perception/segments/summary_tile.hpp"

#include <gtest/gtest.h>

#include <random>

#include "cluxel/error.hpp"
#include "perception/cloud_fixture.hpp"
#include "perception/features/even_tile.hpp"
#include "perception/pipeline.hpp"

namespace cluxel::perception {
namespace {

using scan::Scan;

/// Three scans of a sloping street with a wall, over four tiles.
std::vector<Scan> scansOfStreet() {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> along(-14, 14);
  std::normal_distribution<double> noise(0, 0.004);
  std::vector<Scan> scans;
  for (int s = 0; s < 3; ++s) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 30000; ++i) {
      const double x = along(random), y = along(random);
      points.emplace_back(x, y, 100 + 0.04 * x + noise(random));
    }
    for (int i = 0; i < 3000; ++i) points.emplace_back(along(random), 6 + noise(random), 100 + std::abs(along(random)));
    scans.push_back(testing::scanOf(points));
  }
  return scans;
}

TEST(SummaryTile, CountsAndMeansAreThoseOfThePoints) {
  const std::vector<Scan> scans = scansOfStreet();
  const TileOutputs tiles = perceive(scans, {}, 1);
  ASSERT_EQ(tiles.points.size(), 4u);
  for (const auto& [key, points] : tiles.points) {
    const CluxelTile& cluxels = tiles.cluxels.at(key);
    const SummaryTile summary = summaryOf(points, cluxels);
    ASSERT_EQ(summary.size(), cluxels.size());
    ASSERT_EQ(summary.scans.size(), 3u);
    for (std::uint32_t c = 0; c < summary.size(); ++c) {
      std::map<std::uint32_t, std::vector<Eigen::Vector3d>> by_scan;
      for (std::uint32_t i = 0; i < points.size(); ++i)
        if (cluxels.point_cluxel[i] == c) by_scan[points.scan[i]].push_back(points.at(i).cast<double>());
      ASSERT_EQ(summary.view_offset[c + 1] - summary.view_offset[c], by_scan.size());
      std::uint32_t view = summary.view_offset[c];
      for (const auto& [number, seen] : by_scan) {
        EXPECT_EQ(summary.view_scan[view], number);
        EXPECT_EQ(summary.view_point_count[view], seen.size());
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const Eigen::Vector3d& point : seen) sum += point;
        const Eigen::Vector3d mean = sum / static_cast<double>(seen.size());
        EXPECT_LE((summary.viewMean(c, view) - mean).cwiseAbs().maxCoeff(), 0.00051);
        ++view;
      }
      EXPECT_EQ(summary.seed_point[c], points.point[cluxels.seed[c]]);
      EXPECT_EQ(summary.seed_scan[c], points.scan[cluxels.seed[c]]);
    }
    EXPECT_EQ(toBytes(summaryTileFromBytes(toBytes(summary))), toBytes(summary));
  }
}

TEST(SummaryTile, DamagedBytesAreRefused) {
  const TileOutputs tiles = perceive(scansOfStreet(), {}, 1);
  const TileKey key = tiles.points.begin()->first;
  const SummaryTile summary = summaryOf(tiles.points.at(key), tiles.cluxels.at(key));
  const std::string bytes = toBytes(summary);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97)
    EXPECT_THROW(summaryTileFromBytes(bytes.substr(0, size)), Error);
  SummaryTile wrong = summary;
  ++wrong.view_point_count.front();
  EXPECT_THROW(summaryTileFromBytes(toBytes(wrong)), Error);
  wrong = summary;
  wrong.seed_scan.back() = 3;
  EXPECT_THROW(summaryTileFromBytes(toBytes(wrong)), Error);
}

/// A street as high as 100 m that begins at x = 0, with grass before it.
double streetAt(double x, double y) {
  const auto cell = [](double v) { return static_cast<long>(std::floor(v / 0.3)); };
  return x > 0 ? 100 : 100 + 0.05 * static_cast<double>((cell(x) * 7 + cell(y) * 13) % 5);
}

TEST(EvenTile, CellsAreTheSameWhereverTilesCutTheGround) {
  const auto evenAround = [](double shift_m) {
    std::vector<Eigen::Vector3d> points;
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.003);
    for (int j = -190; j < 190; ++j)
      for (int i = -190; i < 190; ++i) {
        const double x = 0.0625 * (i + 0.5), y = 0.0625 * (j + 0.5);
        points.emplace_back(x + shift_m, y + shift_m, streetAt(x, y) + noise(random));
      }
    const std::vector<Scan> scans{testing::scanOf(points)};
    TileOutputs tiles = perceive(scans, {}, 1);
    for (const auto& [key, tile] : tiles.points)
      tiles.even[key] = evenGroundOf(ringIn(tiles.points, key), ringIn(tiles.ground, key));
    return tiles.even;
  };
  const auto straight = evenAround(0), shifted = evenAround(8);
  std::size_t even = 0, rough = 0, differ = 0, compared = 0;
  for (int j = -32; j < 32; ++j)
    for (int i = -32; i < 32; ++i) {
      const auto at = [&](const std::map<TileKey, EvenTile>& tiles, double shift_m) {
        const double x = kEvenCell_m * (i + 0.5) + shift_m, y = kEvenCell_m * (j + 0.5) + shift_m;
        const TileKey key = TileGrid().tileOf({x, y, 0});
        const Eigen::Vector3d local = Eigen::Vector3d(x, y, 0) - TileGrid().cornerOf(key);
        const auto cell = static_cast<std::size_t>(static_cast<int>(local.y() / kEvenCell_m) * kEvenCellsPerTile +
                                                   static_cast<int>(local.x() / kEvenCell_m));
        return tiles.at(key).distance2[cell];
      };
      const std::uint8_t here = at(straight, 0), there = at(shifted, 8);
      ++compared;
      differ += here != there ? 1 : 0;
      if (i >= 3) even += here != EvenTile::kNotEven ? 1 : 0;
      if (i < -3) rough += here == EvenTile::kNotEven ? 1 : 0;
    }
  EXPECT_EQ(compared, 4096u);
  EXPECT_LE(differ, 40u) << "thinning draws other points at few places";
  EXPECT_GE(even, 64u * 28);
  EXPECT_GE(rough, 64u * 27);
}

TEST(EvenTile, BytesComeBackAndDamagedOnesAreRefused) {
  const TileOutputs tiles = perceive(scansOfStreet(), {}, 1);
  for (const auto& [key, points] : tiles.points) {
    const EvenTile tile = evenGroundOf(ringIn(tiles.points, key), ringIn(tiles.ground, key));
    const std::string bytes = toBytes(tile);
    const EvenTile back = evenTileFromBytes(bytes);
    EXPECT_EQ(back.height, tile.height);
    EXPECT_EQ(back.even_height, tile.even_height);
    EXPECT_EQ(back.distance2, tile.distance2);
    EXPECT_EQ(toBytes(back), bytes);
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97)
      EXPECT_THROW(evenTileFromBytes(bytes.substr(0, size)), Error);
    EvenTile wrong = tile;
    wrong.thing.front() = 2;
    EXPECT_THROW(evenTileFromBytes(toBytes(wrong)), Error);
  }
}

}  // namespace
}  // namespace cluxel::perception
