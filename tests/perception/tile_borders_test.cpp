// SPDX-License-Identifier: Apache-2.0
// A change that is not handed on to a tile changes nothing there: against stages from nothing, after random changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cloud_fixture.hpp"
#include "cluxel/error.hpp"
#include "perception/crf/halo_graph.hpp"

namespace cluxel::perception {
namespace {

using testing::scanOf;
using testing::streetPoints;

/// Streets side by side, over some twenty tiles.
std::vector<Eigen::Vector3d> place(std::uint32_t seed) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 6; ++i)
    for (const Eigen::Vector3d& p : streetPoints(seed + static_cast<std::uint32_t>(i)))
      points.emplace_back(p.x() + 20 * (i % 3), p.y() + 18 * (i / 3), p.z());
  return points;
}

/// A street with points added in a small box, or without those of the box.
std::vector<Eigen::Vector3d> changed(const std::vector<Eigen::Vector3d>& points, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Eigen::Vector3d centre = points[random() % points.size()];
  const double size_m = 0.2 + 2 * unit(random);
  std::vector<Eigen::Vector3d> other = points;
  if (random() % 2 == 0) {
    std::erase_if(other, [&](const Eigen::Vector3d& p) { return (p - centre).cwiseAbs().maxCoeff() < size_m / 2; });
  } else {
    for (int i = 0; i < 60; ++i)
      other.push_back(centre +
                      size_m * (Eigen::Vector3d(unit(random), unit(random), unit(random)).array() - 0.5).matrix());
  }
  return other;
}

template <typename Tile>
OutputChange changeBetween(Stage stage, const Tile& before, const Tile& after, const auto& borders) {
  return changeOf(stage, withBorders(borders(before), toBytes(before)), withBorders(borders(after), toBytes(after)));
}

/// The tiles that read what differs between two runs in the output of one stage.
template <typename Tile>
TileSet readersOf(Stage stage, const std::map<TileKey, Tile>& before, const std::map<TileKey, Tile>& after,
                  const auto& borders, bool by_all = false) {
  TileSet readers;
  for (const auto& [key, tile] : after) {
    const auto old = before.find(key);
    const OutputChange change =
        old == before.end() ? kOtherEverywhere : changeBetween(stage, old->second, tile, borders);
    const auto ring = ringOf(key);
    for (std::size_t place = 0; place < ring.size(); ++place)
      if (by_all ? change.is_read_all : change.is_read[place]) readers.insert(ring[place]);
  }
  return readers;
}

/// What the CRF reads to label a tile, as bytes.
struct LabelInputs {
  std::string bytes;
};
std::string toBytes(const LabelInputs& inputs) {
  return inputs.bytes;
}

std::map<TileKey, LabelInputs> labelInputs(const std::map<TileKey, FeatureTile>& features, const FeatureParams& params,
                                           double halo_m) {
  const std::size_t columns = featureLayout(params).columns.size(),
                    edge_columns = featureLayout(params).edge_columns.size();
  std::map<TileKey, LabelInputs> all;
  for (const auto& [key, tile] : features) {
    const auto ring = ringIn(features, key);
    const HaloGraph graph = haloGraph(ring, halo_m);
    std::string& bytes = all[key].bytes;
    const auto add = [&](const auto* from, std::size_t count) {
      bytes.append(reinterpret_cast<const char*>(from), count * sizeof *from);
    };
    for (const float* row : nodeFeatures(ring, graph, columns)) add(row, columns);
    for (const HaloEdge& edge : graph.edges) {
      add(&edge.ends, 1);
      add(&edge.degrees, 1);
      add(ring[edge.ring]->edge_features.data() + edge.row * edge_columns, edge_columns);
    }
  }
  return all;
}

struct Count {
  std::size_t differ = 0, read = 0, around = 0;
};

/// Every tile whose output differs is among `readers`.
template <typename Tile>
void check(const char* stage, const std::map<TileKey, Tile>& before, const std::map<TileKey, Tile>& after,
           const TileSet& readers, const TileSet& changed_input, Count& count) {
  TileSet all;
  for (const auto& [key, tile] : after) {
    all.insert(key);
    const auto old = before.find(key);
    if (old != before.end() && toBytes(old->second) == toBytes(tile)) continue;
    ++count.differ;
    EXPECT_TRUE(readers.contains(key)) << stage << " of tile " << key.x << " " << key.y;
  }
  for (const TileKey& key : readers) count.read += all.contains(key) ? 1U : 0U;
  count.around += withRing(changed_input, all).size();
}

template <typename Tile>
TileSet differing(const std::map<TileKey, Tile>& before, const std::map<TileKey, Tile>& after) {
  TileSet tiles;
  for (const auto& [key, tile] : after)
    if (const auto old = before.find(key); old == before.end() || toBytes(old->second) != toBytes(tile))
      tiles.insert(key);
  return tiles;
}

/// Settings that read near and far.
struct Settings {
  PerceptionParams perception;
  LabellingParams labelling;
};

std::vector<Settings> variedSettings() {
  std::vector<Settings> all(4);
  all[1].perception.clustering = {.radius_m = 1.0, .max_reach_m = 2.0};
  all[2].perception.clustering = {.radius_m = 0.05, .max_reach_m = 0.05};
  all[2].labelling.halo_m = 8;
  all[3].perception.features.intensity = true;
  all[3].labelling.halo_m = 0;
  return all;
}

class TileBordersOf : public ::testing::TestWithParam<Settings> {};
INSTANTIATE_TEST_SUITE_P(Settings, TileBordersOf, ::testing::ValuesIn(variedSettings()));

TEST_P(TileBordersOf, TellEveryTileThatAChangeReaches) {
  const PerceptionParams& params = GetParam().perception;
  const BorderWidths widths = borderWidths(params, GetParam().labelling);
  const double halo_m = GetParam().labelling.halo_m;
  std::mt19937 random(7);
  Count cluxels, ground, features, labels;
  for (int round = 0; round < 12; ++round) {
    const std::vector<Eigen::Vector3d> points = place(100 + static_cast<std::uint32_t>(round));
    const std::vector<Scan> scans{scanOf(points)}, other_scans{scanOf(changed(points, random))};
    const TileOutputs a = perceive(scans, params, 1), b = perceive(other_scans, params, 1);
    const auto ofPoints = [&](const TilePoints& tile) { return bordersOf(tile, widths); };
    const auto ofCluxels = [&](const CluxelTile& tile) { return bordersOf(tile, widths); };
    const auto ofFeatures = [&](const FeatureTile& tile) { return bordersOf(tile, widths); };
    const auto groundOfA = [&](const GroundTile& tile) { return bordersOf(tile, a.cluxels.at(tile.key), widths); };
    TileSet read_ground;
    for (const auto& [key, tile] : b.ground) {
      OutputChange change = kOtherEverywhere;
      if (a.ground.contains(key))
        change = changeOf(Stage::Ground, withBorders(groundOfA(a.ground.at(key)), toBytes(a.ground.at(key))),
                          withBorders(bordersOf(tile, b.cluxels.at(key), widths), toBytes(tile)));
      for (std::size_t place = 0; place < 9; ++place)
        if (change.is_read[place]) read_ground.insert(ringOf(key)[place]);
    }
    check("cluxels", a.cluxels, b.cluxels, readersOf(Stage::Points, a.points, b.points, ofPoints),
          differing(a.points, b.points), cluxels);
    check("ground", a.ground, b.ground, readersOf(Stage::Cluxels, a.cluxels, b.cluxels, ofCluxels, true),
          differing(a.cluxels, b.cluxels), ground);
    TileSet read = readersOf(Stage::Cluxels, a.cluxels, b.cluxels, ofCluxels);
    read.merge(TileSet(read_ground));
    check("features", a.features, b.features, read,
          unionOf(differing(a.cluxels, b.cluxels), differing(a.ground, b.ground)), features);
    check("labels", labelInputs(a.features, params.features, halo_m), labelInputs(b.features, params.features, halo_m),
          readersOf(Stage::Features, a.features, b.features, ofFeatures), differing(a.features, b.features), labels);
  }
  for (const Count& count : {cluxels, ground, features, labels}) {
    EXPECT_GT(count.differ, 5U);
    EXPECT_LE(count.read, count.around);
  }
  if (halo_m < 2) {
    EXPECT_LT(10 * labels.read, 9 * labels.around) << "borders spare nothing";
  }
}

/// The bytes of the rows of a cluxel and of its edges.
std::string rowsOf(const FeatureTile& tile, std::uint32_t c) {
  const std::size_t columns = tile.features.size() / tile.size(), edge_columns = featureLayout({}).edge_columns.size();
  const std::size_t first = tile.edge_row_offset[c] * edge_columns, last = tile.edge_row_offset[c + 1] * edge_columns;
  std::string bytes(reinterpret_cast<const char*>(tile.features.data() + c * columns), columns * sizeof(float));
  return bytes.append(reinterpret_cast<const char*>(tile.edge_features.data() + first), (last - first) * sizeof(float));
}

TEST_P(TileBordersOf, RowsNearATileNeedOnlyVolumesNearIt) {
  const PerceptionParams& params = GetParam().perception;
  const BorderWidths widths = borderWidths(params, GetParam().labelling);
  const std::vector<Scan> scans{scanOf(place(300))};
  const TileOutputs all = perceive(scans, params, 1);
  std::size_t rows = 0, spared = 0;
  for (const auto& [reader, own] : all.features) {
    std::map<TileKey, CluxelTile> cluxels;  // with volumes of the tile, and of what is near to it
    const auto ring = ringOf(reader);
    for (std::size_t at = 0; at < ring.size(); ++at) {
      const auto found = all.cluxels.find(ring[at]);
      if (found == all.cluxels.end()) continue;
      CluxelTile& tile = cluxels.emplace(*found).first->second;
      dropVolumes(tile);
      std::vector<std::uint32_t> chosen;
      for (std::uint32_t c = 0; c < tile.size(); ++c)
        if (at == kRingCentre ||
            (neighboursNear(all.points.at(tile.key).at(tile.seed[c]), widths.volumes) >> opposite(at) & 1U) != 0)
          chosen.push_back(c);
      spared += tile.size() - chosen.size();
      addVolumes(ringIn(all.points, tile.key), params.clustering, chosen, tile);
    }
    for (std::size_t at = 0; at < ring.size(); ++at) {
      const auto found = all.features.find(ring[at]);
      if (found == all.features.end()) continue;
      const FeatureTile& full = found->second;
      FeatureTile some = full;
      some.dropRows();
      std::vector<std::uint32_t> chosen;
      for (std::uint32_t c = 0; c < full.size(); ++c)
        if (at == kRingCentre || (neighboursNear(full.center[c], widths.features) >> opposite(at) & 1U) != 0)
          chosen.push_back(c);
      addRows(ringIn(cluxels, ring[at]), ringIn(all.ground, ring[at]), params.features, chosen, some);
      for (const std::uint32_t c : chosen) ASSERT_EQ(rowsOf(some, c), rowsOf(full, c)) << at << " " << c;
      rows += chosen.size();
    }
  }
  EXPECT_GT(rows, 100U);
  EXPECT_GT(spared, 100U);
}

TEST(TileBorders, RefuseABlockThatIsCutShort) {
  const std::string block = withBorders({}, "tile");
  EXPECT_EQ(withoutBorders(block), "tile");
  EXPECT_EQ(withoutBorders("PNTS"), "PNTS") << "earlier versions stored no borders";
  for (std::size_t size = 4; size < block.size() - 4; ++size)
    EXPECT_THROW(withoutBorders(std::string_view(block).substr(0, size)), Error);
}

}  // namespace
}  // namespace cluxel::perception
