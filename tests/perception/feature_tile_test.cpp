// SPDX-License-Identifier: Apache-2.0
// The graph against brute force, and independence of features from order, threads, borders and shifts.
#include "perception/features/feature_tile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cloud_fixture.hpp"
#include "cluxel/error.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

using testing::bytesOf;
using testing::splitAtRandom;
using testing::streetPoints;

TileOutputs street(std::uint32_t seed, unsigned threads = 1) {
  return perceive(splitAtRandom(streetPoints(seed), 3, seed), {}, threads);
}

TileKey ringKey(const TileKey& key, RingIndex name) {
  return ringOf(key)[name.ring];
}

TEST(FeatureTile, JoinsExactlyTheCluxelsWhoseVolumesIntersect) {
  const TileOutputs tiles = street(31);
  for (const auto& [key, tile] : tiles.features) {
    const auto ring = ringIn(tiles.cluxels, key);
    const CluxelTile& own = *ring[kRingCentre];
    for (std::size_t c = 0; c < tile.size(); c += 11) {
      std::vector<std::pair<int, std::uint32_t>> expected, found;
      for (int r = 0; r < 9; ++r)
        for (std::uint32_t i = 0; ring[static_cast<std::size_t>(r)] && i < ring[static_cast<std::size_t>(r)]->size();
             ++i) {
          const CluxelTile& other = *ring[static_cast<std::size_t>(r)];
          const Eigen::Array3f low = other.volume_min[i] + ringShift(r), high = other.volume_max[i] + ringShift(r);
          const bool meets = (own.volume_min[c].array() <= high).all() && (low <= own.volume_max[c].array()).all();
          if (meets && !(r == kRingCentre && i == c)) expected.emplace_back(r, i);
        }
      for (auto e = tile.edge_offset[c]; e < tile.edge_offset[c + 1]; ++e)
        found.emplace_back(tile.edge_target[e].ring, tile.edge_target[e].index);
      EXPECT_EQ(found, expected);
    }
  }
}

using EdgeName = std::array<std::int64_t, 6>;  ///< tile and number of both ends

TEST(FeatureTile, AnEdgeIsThereFromBothEndsAndHasTheSameFeaturesInTwoTiles) {
  const TileOutputs tiles = street(32);
  const std::size_t columns = featureLayout({}).edge_columns.size();
  std::set<EdgeName> edges;
  std::map<EdgeName, std::vector<float>> rows;
  for (const auto& [key, tile] : tiles.features) {
    const float* row = tile.edge_features.data();
    for (std::uint32_t c = 0; c < tile.size(); ++c) {
      EXPECT_EQ(row, tile.edge_features.data() + tile.edge_row_offset[c] * columns);
      for (auto e = tile.edge_offset[c]; e < tile.edge_offset[c + 1]; ++e) {
        const TileKey to = ringKey(key, tile.edge_target[e]);
        const EdgeName name{key.x, key.y, c, to.x, to.y, tile.edge_target[e].index};
        edges.insert(name);
        if (!FeatureTile::hasRow(c, tile.edge_target[e])) continue;
        rows[name] = std::vector<float>(row, row + columns);
        row += columns;
      }
    }
    EXPECT_EQ(row, tile.edge_features.data() + tile.edge_features.size());
  }
  std::size_t across = 0;
  for (const auto& edge : edges) {
    const EdgeName back{edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]};
    ASSERT_TRUE(edges.contains(back));
    const bool leaves_tile = edge[0] != edge[3] || edge[1] != edge[4];
    across += leaves_tile ? 1U : 0U;
    EXPECT_EQ(rows.contains(edge) + rows.contains(back), leaves_tile ? 2 : 1);
    if (!leaves_tile) continue;
    EXPECT_EQ(rows.at(edge), rows.at(back));
  }
  EXPECT_GT(across, 50U);
}

TEST(FeatureTile, FillsEveryColumnWithFiniteNumbers) {
  const TileOutputs tiles = street(33);
  const FeatureLayout layout = featureLayout({});
  EXPECT_EQ(std::set<std::string>(layout.columns.begin(), layout.columns.end()).size(), layout.columns.size());
  for (const auto& [key, tile] : tiles.features) {
    ASSERT_EQ(tile.features.size(), tile.size() * layout.columns.size());
    ASSERT_EQ(tile.edge_features.size(), tile.edge_row_offset.back() * layout.edge_columns.size());
    for (const auto value : tile.features) ASSERT_TRUE(std::isfinite(value));
    for (const auto value : tile.edge_features) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(FeatureTile, BytesOfAnotherVersionAreNotCalledDamaged) {
  FeatureTile tile;
  tile.edge_offset = tile.edge_row_offset = {0};
  std::string bytes = toBytes(tile);
  EXPECT_NO_THROW(featureTileFromBytes(bytes, 0));
  ++bytes[4];
  try {
    featureTileFromBytes(bytes, 0);
    FAIL() << "read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("FEAT is of another version"), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find("damaged"), std::string::npos) << error.what();
  }
}

TEST(FeatureTile, EveryColumnTellsSomethingApart) {
  const TileOutputs tiles = street(34);
  const FeatureLayout layout = featureLayout({});
  for (std::size_t column = 0; column < layout.columns.size(); ++column) {
    std::set<float> values;
    for (const auto& [key, tile] : tiles.features)
      for (std::size_t c = 0; c < tile.size(); ++c) values.insert(tile.features[c * layout.columns.size() + column]);
    EXPECT_GT(values.size(), 3U) << layout.columns[column];
  }
}

TEST(FeatureTile, GroupsAreSwitchedWithoutChangingTheOthers) {
  const auto scans = splitAtRandom(streetPoints(35), 2, 35);
  const TileOutputs all = perceive(scans, {}, 1);
  const FeatureLayout whole = featureLayout({});
  for (int group = 0; group < 7; ++group) {
    PerceptionParams params;
    auto& f = params.features;
    *std::array<bool*, 7>{
        &f.hor, &f.shape, &f.wide_shape, &f.height, &f.pillar, &f.extent, &f.density}[static_cast<std::size_t>(group)] =
        false;
    const FeatureLayout layout = featureLayout(f);
    EXPECT_LT(layout.columns.size(), whole.columns.size());
    EXPECT_NE(layout.hash(), whole.hash());
    const TileOutputs part = perceive(scans, params, 1);
    for (const auto& [key, tile] : part.features)
      for (std::size_t column = 0; column < layout.columns.size(); ++column) {
        const std::size_t there = testing::columnOf(whole, layout.columns[column]);
        for (std::size_t c = 0; c < tile.size(); c += 13)
          EXPECT_EQ(tile.features[c * layout.columns.size() + column],
                    all.features.at(key).features[c * whole.columns.size() + there]);
      }
  }
}

TEST(FeatureTile, OrderOfScansAndNumberOfThreadsDoNotMatter) {
  auto scans = splitAtRandom(streetPoints(36), 5, 36);
  const std::string first = bytesOf(perceive(scans, {}, 1));
  EXPECT_EQ(bytesOf(perceive(scans, {}, 2)), first);
  std::reverse(scans.begin(), scans.end());
  EXPECT_EQ(bytesOf(perceive(scans, {}, 2)), first);
}

TEST(FeatureTile, DependsOnItsRingOnly) {
  const auto scans = splitAtRandom(streetPoints(37), 2, 37);
  auto more = scans;
  more.push_back(testing::scanOf(testing::CloudMaker(38).ball(500, {200, 200, 3}, 2).points()));
  const TileOutputs before = perceive(scans, {}, 1), after = perceive(more, {}, 1);
  EXPECT_GT(after.features.size(), before.features.size());
  for (const auto& [key, tile] : before.features) EXPECT_EQ(toBytes(after.features.at(key)), toBytes(tile));
}

TEST(FeatureTile, IntensityIsZeroWhereAScanHasNone) {
  auto scans = splitAtRandom(streetPoints(39), 1, 39);
  PerceptionParams params;
  params.features.intensity = true;
  const std::size_t column = testing::columnOf(featureLayout(params.features), "intensity.mean");
  const std::size_t columns = featureLayout(params.features).columns.size();
  const auto values = [&] {
    std::set<float> found;
    const TileOutputs tiles = perceive(scans, params, 1);
    for (const auto& [key, tile] : tiles.features)
      for (std::size_t c = 0; c < tile.size(); ++c) found.insert(tile.features[c * columns + column]);
    return found;
  };
  EXPECT_EQ(values(), std::set<float>{0.0F});
  scans[0].points.intensity.assign(scans[0].points.size(), 0.25F);
  EXPECT_EQ(values(), std::set<float>{0.25F});
}

TEST(FeatureTile, TheGraphComesBackAndRowsAreComputedAgainBitForBit) {
  const TileOutputs tiles = street(40);
  for (const auto& [key, whole] : tiles.features) {
    const FeatureTile graph = featureTileFromBytes(toBytes(whole), tiles.cluxels.at(key).size());
    EXPECT_EQ(graph.size(), whole.size());
    EXPECT_EQ(graph.edge_offset, whole.edge_offset);
    EXPECT_EQ(graph.edge_target, whole.edge_target);
    EXPECT_EQ(graph.edge_row_offset, whole.edge_row_offset);
    EXPECT_FALSE(graph.hasRows());
    EXPECT_NE(toBytes(graph), toBytes(whole)) << "rows are missing";
    EXPECT_EQ(toBytes(computeFeatures(ringIn(tiles.cluxels, key), ringIn(tiles.ground, key), {})), toBytes(whole));
  }
}

TEST(FeatureTile, DamagedBytesAndThoseOfOtherCluxelsAreRefused) {
  const TileOutputs tiles = street(40);
  const auto& [key, tile] = *tiles.features.begin();
  const std::size_t cluxels = tiles.cluxels.at(key).size();
  const std::string bytes = toBytes(tile);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97)
    EXPECT_THROW(featureTileFromBytes(bytes.substr(0, size), cluxels), Error);
  EXPECT_THROW(featureTileFromBytes(bytes, cluxels + 1), Error);
  FeatureTile wrong = tile;
  const auto own = std::find_if(wrong.edge_target.begin(), wrong.edge_target.end(),
                                [](RingIndex target) { return target.ring == kRingCentre && target.index > 0; });
  ASSERT_NE(own, wrong.edge_target.end());
  own->index = (1U << 28U) - 1;
  EXPECT_THROW(featureTileFromBytes(toBytes(wrong), cluxels), Error);
}

}  // namespace
}  // namespace cluxel::perception
