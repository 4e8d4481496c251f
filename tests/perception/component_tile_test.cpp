// SPDX-License-Identifier: Apache-2.0
// Components against a flood fill, symmetry of contacts, and independence of tile borders.
#include "perception/segments/component_tile.hpp"

#include <gtest/gtest.h>

#include "base/packing/zstd_packing.hpp"
#include "cluxel/error.hpp"

#include <limits>
#include <random>
#include <set>

#include "perception/cloud_fixture.hpp"
#include "perception/segments/primitive_inputs.hpp"
#include "perception/segments/scene_assembly.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
namespace {

using LabelOf = std::function<PrimitiveLabel(const Eigen::Vector3d& center_map)>;

/// All outputs of a cloud whose labels are given by hand.
struct HandLabelled {
  TileOutputs tiles;
  Scene scene;
};

HandLabelled labelled(const std::vector<Scan>& scans, const LabelOf& label_of) {
  HandLabelled all;
  all.tiles = perceive(scans, {}, 1);
  for (const auto& [key, cluxels] : all.tiles.cluxels) {
    LabelTile tile;
    tile.key = key;
    for (std::size_t c = 0; c < cluxels.size(); ++c) {
      const auto label = label_of(TileGrid().cornerOf(key) + cluxels.own[c].mean.cast<double>());
      tile.label.push_back(static_cast<std::uint8_t>(label));
      tile.probability.push_back({});
      tile.probability.back()[static_cast<std::size_t>(label)] = 1.0F;
    }
    all.tiles.labels.emplace(key, std::move(tile));
  }
  for (const auto& [key, points] : all.tiles.points)
    all.tiles.summaries.emplace(key, summaryOf(points, all.tiles.cluxels.at(key)));
  for (const auto& [key, points] : all.tiles.points)
    all.tiles.components.emplace(key, componentsOf(points, all.tiles.cluxels.at(key), all.tiles.features.at(key),
                                                   all.tiles.labels.at(key), ringIn(all.tiles.ground, key), {}));
  for (const auto& [key, graph] : all.tiles.features)
    all.tiles.contacts.emplace(
        key, contactsOf(ringIn(all.tiles.components, key), ringIn(all.tiles.cluxels, key), graph, {}, {}));
  all.scene = assembleScene(all.tiles, {});
  return all;
}

/// Labels in patches of a metre, drawn anew for each seed.
LabelOf patches(std::uint32_t seed) {
  return [seed](const Eigen::Vector3d& p) {
    std::seed_seq place{static_cast<int>(seed), static_cast<int>(std::floor(p.x())),
                        static_cast<int>(std::floor(p.y())), static_cast<int>(std::floor(p.z()))};
    std::mt19937 random(place);
    return static_cast<PrimitiveLabel>(random() % kPrimitiveLabelCount);
  };
}

/// Component numbers by flood fill over the tile's edges, in the order of first cluxels.
std::vector<std::uint32_t> flooded(const CluxelTile& cluxels, const FeatureTile& graph, const LabelTile& labels) {
  constexpr std::uint32_t kNone = 0xffffffffU;
  std::vector<std::uint32_t> number(cluxels.size(), kNone);
  std::uint32_t next = 0;
  for (std::uint32_t start = 0; start < cluxels.size(); ++start) {
    if (number[start] != kNone) continue;
    std::vector<std::uint32_t> open{start};
    number[start] = next;
    while (!open.empty()) {
      const std::uint32_t a = open.back();
      open.pop_back();
      for (std::uint32_t e = graph.edge_offset[a]; e < graph.edge_offset[a + 1]; ++e) {
        const std::uint32_t b = graph.edge_target[e].index;
        if (graph.edge_target[e].ring != kRingCentre || number[b] != kNone || labels.label[a] != labels.label[b])
          continue;
        Eigen::Vector3f gap =
            (cluxels.box_min[a] - cluxels.box_max[b]).cwiseMax(cluxels.box_min[b] - cluxels.box_max[a]);
        if (gap.cwiseMax(0.0F).norm() > 0.5F) continue;
        number[b] = next;
        open.push_back(b);
      }
    }
    ++next;
  }
  return number;
}

TEST(ComponentTile, HasTheComponentsOfAFloodFill) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const HandLabelled all = labelled({scanOf(streetPoints(seed))}, patches(seed));
    for (const auto& [key, tile] : all.tiles.components) {
      EXPECT_EQ(tile.component_of,
                flooded(all.tiles.cluxels.at(key), all.tiles.features.at(key), all.tiles.labels.at(key)));
      std::uint64_t points = 0;
      for (const Component& component : tile.components) points += component.points;
      EXPECT_EQ(points, all.tiles.points.at(key).size());
      std::uint64_t in_cells = 0;
      for (const FootprintCell& cell : tile.cells) in_cells += cell.count;
      EXPECT_EQ(in_cells, points);
    }
  }
}

TEST(ContactTile, LooksTheSameFromBothEnds) {
  const HandLabelled all = labelled({scanOf(streetPoints(2))}, patches(9));
  std::size_t across = 0, heights = 0;
  for (const auto& [key, tile] : all.tiles.contacts)
    for (const Contact& contact : tile.contacts) {
      const TileKey other = ringOf(key)[contact.to_ring];
      const Contact* back = nullptr;
      for (const Contact& candidate : all.tiles.contacts.at(other).contacts)
        if (candidate.from == contact.to && candidate.to_ring == 8 - contact.to_ring && candidate.to == contact.from)
          back = &candidate;
      ASSERT_NE(back, nullptr) << "seen from one end only";
      EXPECT_EQ(back->edges, contact.edges);
      EXPECT_EQ(back->linked_edges, contact.linked_edges);
      EXPECT_EQ(back->overlaps, contact.overlaps);
      EXPECT_EQ(back->gap, contact.gap);
      EXPECT_NEAR(back->height_difference, -contact.height_difference, 1e-6);
      across += contact.to_ring != kRingCentre ? 1 : 0;
      heights += contact.height_difference != 0 ? 1 : 0;
    }
  EXPECT_GT(across, 10U);
  EXPECT_GT(heights, 10U);
}

/// Cells of horizontal planes near the ground are not compared.
bool isGround(const ComponentTile& tile, std::size_t component, const FootprintCell& cell) {
  return tile.components[component].label == static_cast<std::uint32_t>(PrimitiveLabel::HorizontalPlane) &&
         cell.highest < static_cast<float>(ContactParams{}.ground_layer_m);
}

/// The cell's coordinate from the centre tile's corner; its tile is `step` tiles away.
int acrossTiles(std::uint16_t cell, int step) {
  return cell + step * kFootprintCellsPerTile;
}

/// The gap and the overlaps between two components, from all pairs of their cells; an infinite gap without a near pair.
std::pair<float, std::uint32_t> cellsBetween(const ComponentTile& own, std::size_t from, const ComponentTile& other,
                                             int ring, std::size_t to) {
  std::pair<float, std::uint32_t> result{std::numeric_limits<float>::infinity(), 0};
  const Eigen::Vector3f shift = ringShift(ring);
  for (const FootprintCell& a : own.cellsOf(from))
    for (const FootprintCell& b : other.cellsOf(to)) {
      if (isGround(own, from, a) || isGround(other, to, b)) continue;
      const int dx = acrossTiles(b.x, ring % 3 - 1) - a.x, dy = acrossTiles(b.y, ring / 3 - 1) - a.y;
      const bool touch = std::abs(dx) <= 1 && std::abs(dy) <= 1;
      const float gap = gapBetween(Eigen::Vector3f(a.min.data()), Eigen::Vector3f(a.max.data()),
                                   Eigen::Vector3f(b.min.data()) + shift, Eigen::Vector3f(b.max.data()) + shift);
      if (touch || gap <= static_cast<float>(ContactParams{}.near_m)) result.first = std::min(result.first, gap);
      result.second += touch ? 1 : 0;
    }
  return result;
}

TEST(ContactTile, HasTheGapsAndOverlapsOfAllPairsOfCells) {
  const HandLabelled all = labelled({scanOf(streetPoints(4))}, patches(5));
  std::size_t near = 0, overlapping = 0;
  for (const auto& [key, tile] : all.tiles.contacts) {
    const Ring<ComponentTile> ring = ringIn(all.tiles.components, key);
    for (const Contact& contact : tile.contacts) {
      const auto [gap, overlaps] = cellsBetween(*ring[kRingCentre], contact.from, *ring[contact.to_ring],
                                                static_cast<int>(contact.to_ring), contact.to);
      EXPECT_EQ(contact.overlaps, overlaps);
      if (contact.edges == 0) {
        EXPECT_EQ(contact.gap, static_cast<double>(gap));
      }
      EXPECT_LE(contact.gap, static_cast<double>(gap));
      near += contact.edges == 0 && overlaps == 0 ? 1 : 0;
      overlapping += overlaps > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(near, 10U);
  EXPECT_GT(overlapping, 10U);
}

/// A pole with label "column" over flat ground, optionally with a crown of label "scatter"; the cloud is shifted by its
/// pose.
HandLabelled poleAt(double shift_x_m, bool has_crown) {
  CloudMaker maker(21);
  maker.plane(6000, {10, 2, 0}, {12, 0, 0}, {0, 12, 0}).pole(900, {16, 8, 0.3}, 2.7, 0.1);
  if (has_crown) maker.ball(3000, {16, 8, 4.2}, 1.1);
  Scan scan = scanOf(maker.points());
  scan.has_pose = true;
  scan.T_map_sensor.translation().x() += shift_x_m;
  const double top = has_crown ? 3.05 : 100;
  return labelled({scan}, [top](const Eigen::Vector3d& p) {
    return p.z() < 0.2   ? PrimitiveLabel::HorizontalPlane
           : p.z() < top ? PrimitiveLabel::Column
                         : PrimitiveLabel::Scatter;
  });
}

/// The primitive of the label with the most points.
PrimitiveIndex largest(const Scene& scene, PrimitiveLabel label) {
  PrimitiveIndex best = 0;
  double max_points = 0;
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i)
    if (scene.primitives[i].label == label && scene.primitives[i][Attribute::PointCount] > max_points)
      max_points = scene.primitives[i][Attribute::PointCount], best = i;
  return best;
}

TEST(Scene, APoleOnABorderOfTilesIsOnePrimitiveLikeAnyOther) {
  const HandLabelled split = poleAt(0, false), whole = poleAt(8, false);
  const Primitive& a = split.scene.primitives[largest(split.scene, PrimitiveLabel::Column)];
  const Primitive& b = whole.scene.primitives[largest(whole.scene, PrimitiveLabel::Column)];
  std::set<TileKey> tiles_of_a, tiles_of_b;
  for (const std::uint32_t c : a.cluxels) tiles_of_a.insert(split.scene.cluxels.name[c].tile);
  for (const std::uint32_t c : b.cluxels) tiles_of_b.insert(whole.scene.cluxels.name[c].tile);
  ASSERT_EQ(tiles_of_a.size(), 2U) << "the pole crosses the border";
  ASSERT_EQ(tiles_of_b.size(), 1U);
  for (const AttributeInfo& info : attributeInfos()) {
    if (info.attribute == Attribute::CluxelCount) continue;  // seeds stay in their tile
    EXPECT_NEAR(a[info.attribute], b[info.attribute], 1e-3) << info.name;
  }
  EXPECT_NEAR((b.centroid - a.centroid - Eigen::Vector3d(8, 0, 0)).norm(), 0, 1e-3);
  EXPECT_NEAR((b.box.center - a.box.center - Eigen::Vector3d(8, 0, 0)).norm(), 0, 1e-3);
}

TEST(Scene, ACrownIsAboveItsTrunkAndTheTrunkBelowIt) {
  for (const double shift : {0.0, 8.0}) {
    const HandLabelled tree = poleAt(shift, true);
    const PrimitiveIndex trunk = largest(tree.scene, PrimitiveLabel::Column);
    const PrimitiveIndex crown = largest(tree.scene, PrimitiveLabel::Scatter);
    const auto holds = [&](RelationKind kind, PrimitiveIndex from, PrimitiveIndex to) {
      for (const Relation& relation : tree.scene.relationsOf(from))
        if (relation.kind == kind && relation.to == to) return true;
      return false;
    };
    EXPECT_TRUE(holds(RelationKind::Above, crown, trunk));
    EXPECT_TRUE(holds(RelationKind::Below, trunk, crown));
    EXPECT_FALSE(holds(RelationKind::Above, trunk, crown));
    EXPECT_TRUE(holds(RelationKind::Near, trunk, crown));
    EXPECT_TRUE(holds(RelationKind::Near, crown, trunk));
    EXPECT_TRUE(holds(RelationKind::TouchesGround, trunk, trunk));
    EXPECT_FALSE(holds(RelationKind::TouchesGround, crown, crown));
  }
}

TEST(PrimitiveInputs, TellEveryCluxelOfAPrimitiveInWhateverOrderTheyAreAskedFor) {
  HandLabelled all = labelled({scanOf(streetPoints(3))}, [](const auto&) { return PrimitiveLabel::HorizontalPlane; });
  const std::vector<std::uint64_t> hashes = inputHashes(all.scene, all.tiles.summaries);
  PrimitiveInputs backwards(all.scene, all.tiles.summaries);
  for (auto i = static_cast<PrimitiveIndex>(hashes.size()); i-- > 0;) EXPECT_EQ(backwards.hashOf(i), hashes[i]);
  const auto largest =
      std::max_element(all.scene.primitives.begin(), all.scene.primitives.end(),
                       [](const auto& a, const auto& b) { return a.cluxels.size() < b.cluxels.size(); });
  const auto number = static_cast<PrimitiveIndex>(largest - all.scene.primitives.begin());
  ASSERT_GT(largest->cluxels.size(), 100U) << "more bytes than are hashed at once";
  std::set<std::uint64_t> different{hashes[number]};
  for (const std::uint32_t cluxel : largest->cluxels) {
    ++all.scene.cluxels.point_count[cluxel];
    different.insert(PrimitiveInputs(all.scene, all.tiles.summaries).hashOf(number));
    --all.scene.cluxels.point_count[cluxel];
  }
  EXPECT_EQ(different.size(), largest->cluxels.size() + 1);
}

/// Regression: half a corner at the end of a hull was dropped silently.
TEST(ComponentBytes, AreReadBackOrRefused) {
  ComponentTile tile;
  tile.components.resize(1);
  tile.components[0].points = tile.components[0].cluxels = 1;
  tile.component_of = {0};
  tile.cell_offset = {0, 0}, tile.hull_offset = {0, 1}, tile.scan_offset = {0, 0};
  tile.hull = {{1.5F, 2.5F}};
  const std::string bytes = toBytes(tile);
  EXPECT_EQ(toBytes(componentTileFromBytes(bytes)), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(componentTileFromBytes(bytes.substr(0, size)), Error);
  EXPECT_THROW(componentTileFromBytes(bytes + "x"), Error);
  constexpr std::size_t kHead = 32;  // kind, version, tile, digest
  std::string odd(unpackedBytes(std::string_view(bytes).substr(kHead), std::uint64_t{1} << 30U)->view());
  const std::size_t numbers = odd.find(std::string("\0\0\0\0\xC0\x20\x3F\x40", 8));
  ASSERT_NE(numbers, std::string::npos) << "1.5 and 2.5, bytes of equal weight side by side";
  odd[numbers - 8] = 3;  // the count of numbers
  odd.insert(numbers, sizeof(float), '\0');
  EXPECT_THROW(componentTileFromBytes(bytes.substr(0, kHead) + packedBytes(odd)), Error);
}

/// Each block is valid by itself; only the combination is inconsistent.
TEST(Scene, RefusesBlocksThatDoNotBelongTogether) {
  const auto scans = std::vector{scanOf(streetPoints(3))};
  const auto assembled = [&](const auto& damage) {
    HandLabelled all = labelled(scans, patches(3));
    damage(all);
    return assembleScene(all.tiles, {});
  };
  EXPECT_NO_THROW(assembled([](HandLabelled&) {}));
  EXPECT_THROW(assembled([](HandLabelled& all) { all.tiles.labels.begin()->second.label.pop_back(); }), Error);
  EXPECT_THROW(assembled([](HandLabelled& all) { all.tiles.components.begin()->second.component_of.push_back(0); }),
               Error);
  EXPECT_THROW(
      assembled([](HandLabelled& all) { all.tiles.features.begin()->second.edge_target.front().index = 1 << 27; }),
      Error);
  for (auto Contact::*number : {&Contact::from, &Contact::to}) {
    EXPECT_THROW(assembled([number](HandLabelled& all) {
                   for (auto& [key, tile] : all.tiles.contacts) {
                     if (!tile.contacts.empty()) tile.contacts.front().*number = 1U << 30U;
                   }
                 }),
                 Error);
  }
  EXPECT_THROW(assembled([](HandLabelled& all) { all.tiles.contacts.erase(all.tiles.contacts.begin()); }), Error);
  EXPECT_THROW(assembled([](HandLabelled& all) { all.tiles.summaries.erase(all.tiles.summaries.begin()); }), Error);
}

}  // namespace
}  // namespace cluxel::testing
