// SPDX-License-Identifier: Apache-2.0
// Clustering against brute force, and its properties: order, borders, volumes, moments.
#include "perception/clustering/cluxel_tile.hpp"

#include <gtest/gtest.h>

#include <functional>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cloud_fixture.hpp"
#include "cluxel/error.hpp"
#include "perception/clustering/local_steps.hpp"
#include "perception/clustering/point_grid.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

using testing::splitAtRandom;
using testing::streetPoints;
using testing::tilesOf;

std::map<TileKey, TilePoints> streetTiles(std::uint32_t seed) {
  return tilesOf(splitAtRandom(streetPoints(seed), 3, seed), {});
}

/// Own points by cell of the radius, then as stored: the canonical order.
std::vector<std::uint32_t> canonicalOrder(const TilePoints& tile, double radius_m) {
  std::vector<std::uint32_t> order(tile.size());
  std::iota(order.begin(), order.end(), 0U);
  const CellKeys key(radius_m, radius_m);
  const auto keyOf = [&](std::uint32_t i) { return key(tile.x[i], tile.y[i], tile.z[i]); };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return keyOf(a) < keyOf(b); });
  return order;
}

/// "A point joins the earliest seed within r, or becomes a seed", by brute force.
std::vector<std::uint32_t> bruteClustering(const TilePoints& tile, double radius_m, std::vector<std::uint32_t>& seeds) {
  std::vector<std::uint32_t> cluxel(tile.size());
  const float squared = static_cast<float>(radius_m) * static_cast<float>(radius_m);
  for (const auto i : canonicalOrder(tile, radius_m)) {
    std::uint32_t found = 0;
    const auto isNear = [&](std::uint32_t seed) {
      const Eigen::Vector3f d = tile.at(seed) - tile.at(i);
      return d.x() * d.x() + d.y() * d.y() + d.z() * d.z() <= squared;
    };
    while (found < seeds.size() && !isNear(seeds[found])) ++found;
    if (found == seeds.size()) seeds.push_back(i);
    cluxel[i] = found;
  }
  return cluxel;
}

/// All points of the ring within a distance of a position, relative to the ring's centre tile.
std::vector<Eigen::Vector3f> pointsWithin(const Ring<TilePoints>& ring, const Eigen::Vector3f& place, float reach_m) {
  std::vector<Eigen::Vector3f> found;
  for (int r = 0; r < 9; ++r)
    if (const auto* tile = ring[static_cast<std::size_t>(r)])
      for (std::size_t i = 0; i < tile->size(); ++i)
        if (const Eigen::Vector3f p = tile->at(i) + ringShift(r); (p - place).norm() <= reach_m) found.push_back(p);
  return found;
}

TEST(CluxelTile, GridClusteringEqualsBruteForceClustering) {
  for (const double radius_m : {0.1, 0.2, 0.37}) {
    const auto tiles = streetTiles(11);
    for (const auto& [key, points] : tiles) {
      const CluxelTile clustered = clusterTile(ringIn(tiles, key), {.radius_m = radius_m});
      std::vector<std::uint32_t> seeds;
      EXPECT_EQ(clustered.point_cluxel, bruteClustering(points, radius_m, seeds));
      EXPECT_EQ(clustered.seed, seeds);
    }
  }
}

TEST(CluxelTile, OfPointsThatLieHigherByWholeTilesHasTheSameCluxels) {
  const auto tiles = streetTiles(18);
  for (const float rise_m : {16.0F, -48.0F, 304.0F, 3008.0F}) {
    auto high = tiles;
    for (auto& [key, points] : high)
      for (float& z : points.z) z += rise_m;
    for (const auto& [key, points] : tiles) {
      const CluxelTile there = clusterTile(ringIn(tiles, key), {}), here = clusterTile(ringIn(high, key), {});
      EXPECT_EQ(here.point_cluxel, there.point_cluxel);
      EXPECT_EQ(here.seed, there.seed);
      EXPECT_EQ(here.reach, there.reach);
      ASSERT_EQ(here.size(), there.size());
      for (std::size_t c = 0; c < here.size(); ++c) {
        EXPECT_EQ(here.own[c].mean - Eigen::Vector3f(0, 0, rise_m), there.own[c].mean);
        EXPECT_EQ(here.ball[c].mean - Eigen::Vector3f(0, 0, rise_m), there.ball[c].mean);
        EXPECT_EQ(here.ball[c].scatter, there.ball[c].scatter);
      }
    }
  }
}

TEST(CluxelTile, VolumesHoldAllPointsWithinReachAlsoThoseOfNeighbouringTiles) {
  const auto tiles = streetTiles(12);
  bool crossed = false;
  for (const auto& [key, points] : tiles) {
    const auto ring = ringIn(tiles, key);
    const CluxelTile clustered = clusterTile(ring, {});
    for (std::size_t c = 0; c < clustered.size(); c += 7) {
      Eigen::Vector3f low = points.at(clustered.seed[c]), high = low;
      const auto near = pointsWithin(ring, points.at(clustered.seed[c]), clustered.reach[c] * 1.00001F);
      for (const auto& p : near) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
      EXPECT_LT((low - clustered.volume_min[c]).norm() + (high - clustered.volume_max[c]).norm(), 1e-6);
      EXPECT_FLOAT_EQ(clustered.ball[c].count, static_cast<float>(near.size()));
      crossed = crossed || low.x() < 0 || high.y() > 16;
    }
  }
  EXPECT_TRUE(crossed);
}

TEST(CluxelTile, SparseVolumesGrowUntilTheyHoldEnoughPointsAndDenseOnesDoNot) {
  const ClusterParams params;
  const auto tiles = streetTiles(13);
  std::size_t grown = 0, fixed = 0;
  for (const auto& [key, points] : tiles) {
    const CluxelTile clustered = clusterTile(ringIn(tiles, key), params);
    for (std::size_t c = 0; c < clustered.size(); ++c) {
      EXPECT_GE(clustered.reach[c], static_cast<float>(params.radius_m) * 0.9999F);
      EXPECT_LE(clustered.reach[c], static_cast<float>(params.max_reach_m) * 1.0001F);
      const bool at_limit = clustered.reach[c] > 0.999F * static_cast<float>(params.max_reach_m);
      EXPECT_TRUE(at_limit || clustered.ball[c].count >= static_cast<float>(params.target_points));
      ++(clustered.reach[c] > 1.001F * static_cast<float>(params.radius_m) ? grown : fixed);
    }
  }
  EXPECT_GT(grown, 100U);
  EXPECT_GT(fixed, 100U);
}

TEST(CluxelTile, MomentsAreThoseOfTheCluxelsPoints) {
  const auto tiles = streetTiles(14);
  const auto& [key, points] = *tiles.begin();
  const CluxelTile clustered = clusterTile(ringIn(tiles, key), {});
  std::vector<std::vector<std::uint32_t>> members(clustered.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) members[clustered.point_cluxel[i]].push_back(i);
  for (std::size_t c = 0; c < clustered.size(); ++c) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    const auto count = static_cast<double>(members[c].size());
    for (const std::uint32_t i : members[c]) mean += points.at(i).cast<double>() / count;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : members[c]) {
      const Eigen::Vector3d d = points.at(i).cast<double>() - mean;
      scatter += d * d.transpose();
    }
    ASSERT_FLOAT_EQ(clustered.own[c].count, static_cast<float>(count));
    const Eigen::Vector3d off = clustered.own[c].mean.cast<double>() - mean;
    EXPECT_LT(off.head<2>().norm(), 1e-5);
    EXPECT_LE(std::abs(off.z()), 0.5001 * kHeightStep_m);
    const auto& s = clustered.own[c].scatter;
    const std::array<double, 6> expected{scatter(0, 0), scatter(0, 1), scatter(0, 2),
                                         scatter(1, 1), scatter(1, 2), scatter(2, 2)};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(s[i], expected[i], 1e-6 + 1e-5 * std::abs(expected[i]));
  }
}

TEST(CluxelTile, APointNearABorderJoinsNoSeedBeyondIt) {
  const auto tiles = streetTiles(15);
  for (const auto& [key, points] : tiles) {
    Ring<TilePoints> alone{};
    alone[kRingCentre] = &points;
    EXPECT_EQ(clusterTile(ringIn(tiles, key), {}).point_cluxel, clusterTile(alone, {}).point_cluxel);
  }
}

TEST(CluxelTile, MovingEverythingByWholeTilesChangesNothing) {
  const auto move = [](std::map<TileKey, TilePoints> tiles) {
    std::map<TileKey, TilePoints> moved;
    for (auto& [key, tile] : tiles) {
      const TileKey to{key.x + 1000, key.y - 77};
      tile.key = to;
      moved[to] = tile;
    }
    return moved;
  };
  const auto tiles = streetTiles(16);
  const auto moved = move(tiles);
  for (const auto& [key, tile] : tiles) {
    CluxelTile there = clusterTile(ringIn(moved, {key.x + 1000, key.y - 77}), {});
    there.key = key;
    EXPECT_EQ(toBytes(there), toBytes(clusterTile(ringIn(tiles, key), {})));
  }
}

/// The paper's setting: radius 0.10 m, volumes that do not grow.
ClusterParams paperClustering() {
  return {.radius_m = 0.10, .max_reach_m = 0.10, .target_points = 1};
}

TEST(CluxelTile, ThePapersModeHasFixedVolumesOfATenthOfAMetre) {
  const auto tiles = streetTiles(17);
  const CluxelTile clustered = clusterTile(ringIn(tiles, tiles.begin()->first), paperClustering());
  for (const auto reach : clustered.reach) EXPECT_NEAR(reach, 0.10, 1e-6);
}

TEST(CluxelTile, SettingsOutsideTheirRangeAreRefusedByName) {
  try {
    checkRanges(ClusterParams{.radius_m = -1});
    FAIL() << "took a negative radius";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_NE(std::string(error.what()).find("clustering.radius"), std::string::npos);
  }
  EXPECT_NE(hashOf(ClusterParams{}), hashOf(paperClustering()));
}

std::vector<std::uint32_t> everyCluxelOf(const CluxelTile& tile) {
  std::vector<std::uint32_t> all(tile.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

TEST(CluxelTile, ComesBackFromItsPointsBitForBit) {
  for (const ClusterParams& params : {ClusterParams{}, paperClustering()}) {
    auto tiles = streetTiles(18);
    for (auto& [key, points] : tiles) {
      points.intensity.resize(points.size());
      for (std::size_t i = 0; i < points.size(); ++i) points.intensity[i] = static_cast<float>(i % 7);
    }
    for (const auto& [key, points] : tiles) {
      const std::string bytes = toBytes(clusterTile(ringIn(tiles, key), params));
      CluxelTile tile = cluxelTileFromBytes(bytes, points);
      EXPECT_FALSE(tile.hasVolumes());
      EXPECT_NE(toBytes(tile), bytes) << "volumes are missing";
      addVolumes(ringIn(tiles, key), params, everyCluxelOf(tile), tile);
      EXPECT_EQ(toBytes(tile), bytes);
      dropVolumes(tile);
      EXPECT_FALSE(tile.hasVolumes());
    }
  }
}

TEST(CluxelTile, DamagedBytesAndThoseOfOtherPointsAreRefused) {
  const auto tiles = streetTiles(18);
  const TilePoints& points = tiles.begin()->second;
  const CluxelTile tile = clusterTile(ringIn(tiles, tiles.begin()->first), {});
  const std::string bytes = toBytes(tile);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97)
    EXPECT_THROW(cluxelTileFromBytes(bytes.substr(0, size), points), Error);
  TilePoints fewer = points;
  fewer.x.pop_back();
  EXPECT_THROW(cluxelTileFromBytes(bytes, fewer), Error);
  for (const auto& damage : {std::function<void(CluxelTile&)>([](CluxelTile& of) { of.seed[3] = 1U << 30U; }),
                             std::function<void(CluxelTile&)>([](CluxelTile& of) { of.point_cluxel[3] = 1U << 30U; }),
                             std::function<void(CluxelTile&)>([](CluxelTile& of) { of.seed[3] = of.seed[4]; })}) {
    CluxelTile wrong = tile;
    damage(wrong);
    EXPECT_THROW(cluxelTileFromBytes(toBytes(wrong), points), Error);
  }
}

}  // namespace
}  // namespace cluxel::perception
