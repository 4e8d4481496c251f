// SPDX-License-Identifier: Apache-2.0
// Ways of a tile follow from its ring, and those of a changed map are those of a map made from nothing.
#include "mapping/build/way_tiles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "cluxel/error.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/ways/skeleton.hpp"
#include "mapping/ways/way_stage.hpp"

namespace cluxel::mapping {
namespace {

using perception::EvenTile;
using perception::TileKey;
using EvenTiles = std::map<TileKey, EvenTile>;

/// Strips and squares of even ground, up to 20 m wide, that lie over many tiles; holes, steps, things and gaps.
class RandomGround {
 public:
  explicit RandomGround(std::uint32_t seed) : random_(seed) {
    for (int i = 0; i < 7; ++i) strips_.push_back({place(), place(), number(0.3, i == 0 ? 10 : 3)});
  }

  EvenTile tileAt(const TileKey& key) {
    EvenTile tile;
    tile.key = key;
    const double holes = number(0, 0.02), gaps = number(0, 0.05), kerb_x = number(-20, 60);
    for (std::uint32_t cell = 0; cell < kCellsOfTile; ++cell) {
      const Eigen::Vector2d at = centreOf(placeOf(key, cell));
      const double height = std::round((0.02 * at.x() + (at.x() > kerb_x ? 0.125 : 0)) * 2048) / 2048;
      const bool is_even = isPaved(at) && number(0, 1) > holes;
      tile.height.push_back(static_cast<float>(height));
      tile.measured.push_back(number(0, 1) > gaps ? 1 : 0);
      tile.thing.push_back(number(0, 1) < 0.2 * holes ? 1 : 0);
      tile.distance2.push_back(is_even ? 1 : EvenTile::kNotEven);
      tile.even_height.push_back(is_even ? static_cast<float>(height) : 0.0F);
    }
    return tile;
  }
  double number(double from, double to) { return std::uniform_real_distribution(from, to)(random_); }

 private:
  struct Strip {
    Eigen::Vector2d from, to;
    double half_width;
  };
  Eigen::Vector2d place() { return {number(-40, 60), number(-40, 60)}; }
  bool isPaved(const Eigen::Vector2d& at) const {
    for (const Strip& strip : strips_) {
      const Eigen::Vector2d along = strip.to - strip.from, p = at - strip.from;
      if ((p - along * std::clamp(p.dot(along) / along.squaredNorm(), 0.0, 1.0)).norm() < strip.half_width) return true;
    }
    return false;
  }

  std::mt19937 random_;
  std::vector<Strip> strips_;
};

EvenTiles randomTiles(RandomGround& ground, int from, int to) {
  EvenTiles tiles;
  for (int y = from; y <= to; ++y)
    for (int x = from; x <= to; ++x)
      if (ground.number(0, 1) < 0.9) tiles.emplace(TileKey{x, y}, ground.tileAt({x, y}));
  return tiles;
}

TileSet keysOf(const EvenTiles& tiles) {
  TileSet keys;
  for (const auto& [key, tile] : tiles) keys.insert(key);
  return keys;
}

EvenTileSource sourceOf(const EvenTiles& tiles) {
  return [&](const TileKey& key) { return tiles.at(key); };
}

TEST(WayTiles, FollowFromTheRingOfATile) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    RandomGround ground(seed);
    const EvenTiles even = randomTiles(ground, -1, 2);
    const TileSet all = keysOf(even);
    const auto surfaces = surfaceTilesOf(all, all, sourceOf(even));
    const auto surface_at = [&](const TileKey& key) { return surfaces.at(key); };
    const auto ways = wayTilesOf(all, all, sourceOf(even), surface_at);
    for (const TileKey& key : all) {
      const TileSet ring = withRing({key}, all);
      ASSERT_EQ(surfaceTilesOf({key}, ring, sourceOf(even)).at(key), surfaces.at(key)) << seed;
      ASSERT_EQ(toBytes(wayTilesOf({key}, ring, sourceOf(even), surface_at).at(key)), toBytes(ways.at(key))) << seed;
    }
  }
}

TEST(WayTiles, AreReadAsTheyWereWritten) {
  RandomGround ground(3);
  const EvenTiles even = randomTiles(ground, -1, 2);
  const TileSet all = keysOf(even);
  const auto surfaces = surfaceTilesOf(all, all, sourceOf(even));
  for (const auto& [key, surface] : surfaces) EXPECT_EQ(surfaceTileFromBytes(surfaceBytes(key, surface), key), surface);
  std::size_t cells = 0, kerb_cells = 0, links = 0;
  for (const auto& [key, tile] :
       wayTilesOf(all, all, sourceOf(even), [&](const TileKey& at) { return surfaces.at(at); })) {
    const WayTile read = wayTileFromBytes(toBytes(tile));
    EXPECT_EQ(toBytes(read), toBytes(tile));
    EXPECT_EQ(read.middle.height, tile.middle.height);
    EXPECT_EQ(read.step_m, tile.step_m);
    EXPECT_EQ(read.links, tile.links);
    EXPECT_THROW(wayTileFromBytes(toBytes(tile).substr(0, toBytes(tile).size() - 1)), Error);
    cells += tile.middle.cell.size(), kerb_cells += tile.kerbs.cell.size(), links += tile.links.size();
  }
  EXPECT_GT(cells, 100U);
  EXPECT_GT(kerb_cells, 20U);
  EXPECT_GT(links, 10U);
}

/// Connected parts of the cells where `inside` is `value`, over corners or not. Cells outside of the tiles are outside.
std::size_t partsOf(const TileCells& cells, std::vector<std::uint8_t> inside, bool over_corners) {
  std::size_t parts = 0;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (inside[start] == 0) continue;
    ++parts;
    std::vector<std::uint32_t> part{start};
    inside[start] = 0;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (std::size_t way = 0; way < 8; way += over_corners ? 1 : 2) {
        const std::uint32_t near = cells.step(part[at], kAroundCell[way][0], kAroundCell[way][1]);
        if (near != kNoCell && inside[near] != 0) inside[near] = 0, part.push_back(near);
      }
  }
  return parts;
}

TEST(Skeleton, IsConnectedAsThePatchesAreWithTheirHoles) {
  std::ptrdiff_t cells_left = 0, cells_before = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    RandomGround ground(seed);
    const TileCells cells({{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}});
    std::vector<std::uint8_t> inside;
    for (const TileKey& key : cells.keys())
      for (const std::uint8_t distance2 : ground.tileAt(key).distance2) inside.push_back(distance2 == 1 ? 1 : 0);
    for (std::uint32_t cell = 0; cell < cells.size(); ++cell)  // a margin, so that all outside is one part
      if (cells.step(cell, 1, 0) == kNoCell || cells.step(cell, -1, 0) == kNoCell ||
          cells.step(cell, 0, 1) == kNoCell || cells.step(cell, 0, -1) == kNoCell)
        inside[cell] = 0;
    const auto skeleton = skeletonOf(cells, squaredEdgeDistances(cells, inside), kFarthestEdge - 1, 1);
    const auto outsideOf = [](std::vector<std::uint8_t> values) {
      for (std::uint8_t& value : values) value = value == 0 ? 1 : 0;
      return values;
    };
    EXPECT_EQ(partsOf(cells, skeleton, true), partsOf(cells, inside, true));
    EXPECT_EQ(partsOf(cells, outsideOf(skeleton), false), partsOf(cells, outsideOf(inside), false));
    cells_left += std::count(skeleton.begin(), skeleton.end(), 1);
    cells_before += std::count(inside.begin(), inside.end(), 1);
  }
  EXPECT_GT(cells_before, 10000);
  EXPECT_LT(cells_left, cells_before / 4);
}

/// Areas of the regions by a flood over all tiles.
std::vector<double> floodedAreas(const EvenTiles& even) {
  const TileSet all = keysOf(even);
  const GroundCells ground = surfaceOf({all.begin(), all.end()}, sourceOf(even));
  const TileCells& cells = ground.cells;
  std::vector<std::uint8_t> left(cells.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell)
    left[cell] = (ground.measured[cell] != 0 || ground.even[cell] != 0) && ground.thing[cell] == 0 ? 1 : 0;
  std::vector<double> areas;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (left[start] == 0) continue;
    std::vector<std::uint32_t> part{start};
    left[start] = 0;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (const auto& [dx, dy] : kAroundCell) {
        const std::uint32_t near = cells.step(part[at], dx, dy);
        if (near == kNoCell || left[near] == 0) continue;
        if (std::abs(ground.height[near] - ground.height[part[at]]) > kKerbLow_m) continue;
        left[near] = 0;
        part.push_back(near);
      }
    const double area = static_cast<double>(part.size()) * kWayCell_m * kWayCell_m;
    if (area >= kLeastRegion_m2) areas.push_back(area);
  }
  return areas;
}

TEST(WayTiles, PartsOfRegionsAddUpToThoseOfAFlood) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    RandomGround ground(seed);
    const EvenTiles even = randomTiles(ground, -2, 2);
    std::vector<double> areas;
    for (const Region& region : waysOf(keysOf(even), sourceOf(even), {}).regions) areas.push_back(region.area_m2);
    EXPECT_EQ(areas, floodedAreas(even));
    EXPECT_GT(areas.size(), 1U);
  }
}

/// A map file that holds even ground and ways.
struct StoredGround {
  std::shared_ptr<rdf::Environment> environment = rdf::Environment::temporary();

  TileSet update(const EvenTiles& even, const TileSet& changed, unsigned threads) {
    rdf::WriteTransaction transaction = environment->write();
    storeTiles(transaction, keysOf(even));
    for (const TileKey& key : changed)
      if (const auto found = even.find(key); found != even.end())
        transaction.putBlock(tables::kEven, tables::keyOf(key), toBytes(found->second));
      else
        transaction.eraseBlock(tables::kEven, tables::keyOf(key));
    const TileSet updated = updateWayTiles(transaction, changed, {}, threads);
    transaction.commit();
    return updated;
  }
  std::string bytes() const {
    std::string all;
    const rdf::ReadTransaction transaction = environment->read();
    for (const auto table : {tables::kSurfaces, tables::kWays})
      transaction.forEachBlock(table, "",
                               [&](std::string_view key, std::string_view block) { all.append(key).append(block); });
    return all;
  }
  WayGraph ways() const { return storedWays(environment->read()); }
};

void expectSame(const WayGraph& a, const WayGraph& b) {
  ASSERT_EQ(a.ways.size(), b.ways.size());
  ASSERT_EQ(a.junctions.size(), b.junctions.size());
  ASSERT_EQ(a.regions.size(), b.regions.size());
  ASSERT_EQ(a.kerbs.size(), b.kerbs.size());
  for (std::size_t i = 0; i < a.ways.size(); ++i) {
    EXPECT_EQ(a.ways[i].line, b.ways[i].line);
    EXPECT_EQ(a.ways[i].median_width_m, b.ways[i].median_width_m);
    EXPECT_EQ(a.ways[i].junctions, b.ways[i].junctions);
    EXPECT_EQ(a.ways[i].region, b.ways[i].region);
  }
  for (std::size_t i = 0; i < a.kerbs.size(); ++i) EXPECT_EQ(a.kerbs[i].line, b.kerbs[i].line);
}

TEST(WayTiles, OfAChangedMapAreThoseOfAMapMadeFromNothing) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    RandomGround ground(seed);
    EvenTiles even = randomTiles(ground, -1, 3);
    StoredGround map;
    map.update(even, keysOf(even), 1);
    ASSERT_GT(map.ways().ways.size(), 3U);
    for (int change = 0; change < 6; ++change) {
      TileSet changed;
      for (int i = 0; i < 1 + change % 3; ++i) {
        const TileKey key{static_cast<int>(ground.number(-2, 4)), static_cast<int>(ground.number(-2, 4))};
        changed.insert(key);
        even.erase(key);
        if (ground.number(0, 1) < 0.7) even.emplace(key, ground.tileAt(key));
      }
      const TileSet updated = map.update(even, changed, 1 + static_cast<unsigned>(change) % 2);
      StoredGround fresh;
      fresh.update(even, keysOf(even), 2);
      ASSERT_TRUE(map.bytes() == fresh.bytes()) << seed << " " << change;
      expectSame(map.ways(), waysOf(keysOf(even), sourceOf(even), {}));
      for (const TileKey& tile : updated)
        EXPECT_TRUE(std::any_of(changed.begin(), changed.end(), [&](const TileKey& key) {
          return std::abs(key.x - tile.x) <= 2 && std::abs(key.y - tile.y) <= 2;
        }));
    }
  }
}

TEST(WayTiles, ThatAreMissingAreComputed) {
  RandomGround ground(5);
  const EvenTiles even = randomTiles(ground, -1, 1);
  StoredGround map, other;
  map.update(even, keysOf(even), 1);
  other.update(even, keysOf(even), 1);
  {
    rdf::WriteTransaction transaction = other.environment->write();
    transaction.eraseBlock(tables::kWays, tables::keyOf(even.begin()->first));
    transaction.eraseBlock(tables::kSurfaces, tables::keyOf(even.rbegin()->first));
    transaction.commit();
  }
  EXPECT_THROW(other.ways(), Error);
  other.update(even, {}, 1);
  EXPECT_TRUE(map.bytes() == other.bytes());
}

TEST(WayTiles, ThatAreUnchangedAreNotWritten) {
  RandomGround ground(6);
  const EvenTiles even = randomTiles(ground, -1, 2);
  StoredGround map;
  EXPECT_EQ(map.update(even, keysOf(even), 1), keysOf(even));
  EXPECT_TRUE(map.update(even, keysOf(even), 1).empty());
}

}  // namespace
}  // namespace cluxel::mapping
