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

std::map<TileKey, LabelInputs> labelInputs(const std::map<TileKey, FeatureTile>& features) {
  const std::size_t columns = featureLayout({}).columns.size(), edge_columns = featureLayout({}).edge_columns.size();
  std::map<TileKey, LabelInputs> all;
  for (const auto& [key, tile] : features) {
    const auto ring = ringIn(features, key);
    const HaloGraph graph = haloGraph(ring, LabellingParams{}.halo_m);
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

TEST(TileBorders, TellEveryTileThatAChangeReaches) {
  const PerceptionParams params;
  const BorderWidths widths = borderWidths(params, {});
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
    check("labels", labelInputs(a.features), labelInputs(b.features),
          readersOf(Stage::Features, a.features, b.features, ofFeatures), differing(a.features, b.features), labels);
  }
  for (const Count& count : {cluxels, ground, features, labels}) {
    EXPECT_GT(count.differ, 10U);
    EXPECT_LE(count.read, count.around);
  }
  EXPECT_LT(10 * (cluxels.read + labels.read), 9 * (cluxels.around + labels.around)) << "borders spare nothing";
}

TEST(TileBorders, RefuseABlockThatIsCutShort) {
  const std::string block = withBorders({}, "tile");
  EXPECT_EQ(withoutBorders(block), "tile");
  for (std::size_t size = 0; size < block.size() - 4; ++size)
    EXPECT_THROW(withoutBorders(std::string_view(block).substr(0, size)), Error);
}

}  // namespace
}  // namespace cluxel::perception
