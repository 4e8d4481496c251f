// SPDX-License-Identifier: Apache-2.0
// Which cluxels are kept of regions, on a field of cluxels over several tiles.
#include "tasks/changes/kept_cluxels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tasks/changes/kept_cells.hpp"

namespace cluxel::tasks {
namespace {

constexpr int kTiles = 3, kPerTile = 8, kSide = kTiles * kPerTile;  ///< of the square field
constexpr double kStep_m = perception::kTileSize_m / kPerTile;

/// Cluxels ordered by tile, as those of a map are. They intersect those beside them, also in the next tile.
struct Field {
  ChangedCluxels all;
  std::vector<RayFindings> gone;

  std::vector<ChangeGroup> clusters(CluxelChange kind) const { return clustersOf(kind, all); }
};

struct Place {
  int x = 0, y = 0;
};

std::vector<Place> placesByTile() {
  std::vector<Place> places;
  for (int tile = 0; tile < kTiles * kTiles; ++tile)
    for (int cluxel = 0; cluxel < kPerTile * kPerTile; ++cluxel)
      places.push_back({tile / kTiles * kPerTile + cluxel / kPerTile, tile % kTiles * kPerTile + cluxel % kPerTile});
  return places;
}

/// `change(place)` states what changed; five scans saw through that.
template <typename Change>
Field fieldOf(const Change& change) {
  Field field;
  const std::vector<Place> places = placesByTile();
  field.all.cluxels.edge_offset.push_back(0);
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const auto [x, y] = places[i];
    const Eigen::Vector3d corner(kStep_m * x, kStep_m * y, 1);
    const Eigen::Vector3d center = corner + Eigen::Vector3d::Constant(kStep_m / 2);
    field.all.cluxels.name.push_back({perception::TileGrid().tileOf(center), i});
    field.all.cluxels.center.push_back(center), field.all.cluxels.low_corner.push_back(corner);
    field.all.places.push_back({center, {}, {}});
    field.all.cluxels.extent.push_back(Eigen::Vector3f::Constant(static_cast<float>(kStep_m)));
    for (std::uint32_t other = 0; other < places.size(); ++other)
      if (other != i && std::abs(places[other].x - x) <= 1 && std::abs(places[other].y - y) <= 1)
        field.all.cluxels.edge_target.push_back(other);
    field.all.cluxels.edge_offset.push_back(static_cast<std::uint32_t>(field.all.cluxels.edge_target.size()));
    field.all.number.push_back(i), field.all.object.push_back(0), field.all.is_told.push_back(true);
    const CluxelChange changed = change(places[i]);
    field.all.changes.push_back(changed);
    const RayFindings hit{.hits = 511, .sparse_hits = 511};
    const RayFindings through{.seen_through = 31};
    const bool has_left = changed == CluxelChange::Vanished, has_come = changed == CluxelChange::Appeared;
    field.all.before.push_back(has_come ? through : hit);
    field.all.after.push_back(has_left ? through : hit);
    field.gone.push_back(has_left || has_come ? through : RayFindings());
  }
  return field;
}

perception::TileSet tilesFrom(int tile, int end) {
  perception::TileSet tiles;
  for (int i = tile; i < end; ++i) tiles.insert({i / kTiles, i % kTiles});
  return tiles;
}

/// Adds the field in regions of some tiles. `after_each(region, unread, kept)` is called after each.
template <typename AfterEach>
KeptCluxels keptOf(const Field& field, int tiles_of_region, const AfterEach& after_each) {
  KeptCluxels kept;
  for (int tile = 0; tile < kTiles * kTiles; tile += tiles_of_region) {
    const int end = std::min(tile + tiles_of_region, kTiles * kTiles);
    const perception::TileSet unread = tilesFrom(end, kTiles * kTiles);
    mapping::MapRegion region;
    region.tiles = tilesFrom(tile, end);
    region.scene.cluxels = field.all.cluxels;
    region.number = field.all.number, region.object = field.all.object;
    for (const auto& name : field.all.cluxels.name) region.is_own.push_back(region.tiles.contains(name.tile));
    kept.add(region, {field.all.is_told, field.all.changes, field.gone, field.all.places}, unread);
    after_each(region, unread, kept);
  }
  return kept;
}

KeptCluxels keptOf(const Field& field, int tiles_of_region) {
  return keptOf(field, tiles_of_region, [](const auto&...) {});
}

/// The clusters of what is kept, by numbers in the map.
std::vector<ChangeGroup> clustersKept(KeptCluxels kept, const Field& field, CluxelChange kind) {
  KeptCluxels::Clusters clusters = kept.take();
  for (std::size_t i = 0; i < clusters.cluxels.number.size(); ++i) {
    clusters.cluxels.before[i] = field.all.before[clusters.cluxels.number[i]];
    clusters.cluxels.after[i] = field.all.after[clusters.cluxels.number[i]];
  }
  const std::size_t time = kind == CluxelChange::Vanished ? 0 : 1;
  std::vector<ChangeGroup> found = clustersAmong(clusters.groups[time], kind, clusters.cluxels);
  for (ChangeGroup& group : found)
    for (std::uint32_t& cluxel : group) cluxel = clusters.cluxels.number[cluxel];
  return found;
}

CluxelChange blocks(const Place& place) {
  const bool is_block = place.x >= 6 && place.x < 10 && place.y >= 6 && place.y < 10;
  const bool is_small = place.x >= 18 && place.x < 20 && place.y >= 2 && place.y < 4;
  return is_block || is_small ? CluxelChange::Vanished : CluxelChange::Undecided;
}

TEST(KeptCluxels, AClusterAcrossBordersIsKeptWithWhatIsNear) {
  const Field field = fieldOf(blocks);
  const KeptCluxels::Clusters clusters = keptOf(field, 1).take();
  ASSERT_EQ(clusters.groups[kBefore].size(), 1U);
  EXPECT_EQ(clusters.groups[kBefore].front().size(), 16U);
  EXPECT_EQ(clusters.cluxels.number.size(), 36U) << "the small block is dropped";
}

TEST(KeptCluxels, TellWhatBecameOfAChangedOne) {
  const Field field = fieldOf(blocks);
  const KeptCluxels kept = keptOf(field, 4);
  for (std::uint32_t i = 0; i < field.all.number.size(); ++i) {
    if (field.all.changes[i] != CluxelChange::Vanished) continue;
    const bool is_large_block = field.all.cluxels.center[i].x() < 10 * kStep_m;
    EXPECT_EQ(kept.fateOf(i), is_large_block ? KeptCluxels::Fate::InCluster : KeptCluxels::Fate::Dropped);
  }
}

TEST(KeptCluxels, ClustersAreThoseOfAllCluxelsTogether) {
  std::size_t clusters = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    const Field field = fieldOf([&](const Place& place) {
      const double chance = std::uniform_real_distribution<>(0, 1)(random);
      if (chance < 0.2) return CluxelChange::Undecided;
      if (chance < 0.4) return CluxelChange::Stable;
      return (place.x / 5 + place.y / 5) % 2 == 0 ? CluxelChange::Vanished : CluxelChange::Appeared;
    });
    for (const CluxelChange kind : {CluxelChange::Vanished, CluxelChange::Appeared}) {
      const std::vector<ChangeGroup> expected = field.clusters(kind);
      clusters += expected.size();
      for (const int tiles : {1, 2, 4, 9})
        EXPECT_EQ(clustersKept(keptOf(field, tiles), field, kind), expected) << "seed " << seed << ", " << tiles;
    }
  }
  EXPECT_GE(clusters, 20U);
}

TEST(KeptCells, CellsOfAPossibleClusterAreKept) {
  const Field field = fieldOf(blocks);
  for (const int tiles : {1, 4, 9}) {
    KeptCells kept;
    const auto addCells = [&](const mapping::MapRegion& region, const auto& unread, const KeptCluxels& cluxels) {
      std::vector<PointCell> cells;
      for (std::uint32_t i = 0; i < field.all.number.size(); ++i) {
        if (!region.is_own[i]) continue;
        PointCell cell{.key = {field.all.cluxels.name[i].tile, i}, .place = field.all.cluxels.center[i], .cluxel = i};
        cell.other.through_scans = 31;
        cell.is_of_changed_cluxel = field.all.changes[i] == CluxelChange::Vanished;
        cells.push_back(cell);
      }
      kept.add(region, cells, unread, cluxels);
    };
    keptOf(field, tiles, addCells);
    EXPECT_EQ(kept.take().cells.size(), 16U) << tiles << " tiles a region";
  }
}

}  // namespace
}  // namespace cluxel::tasks
