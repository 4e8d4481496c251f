// SPDX-License-Identifier: Apache-2.0
// Ways on made ground with known middles and widths, and that a map's ways follow every change of it.
#include "mapping/ways/ways.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "mapping/change/map_change.hpp"
#include "mapping/small_campus.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

/// A number in [-1, 1) that looks random and depends on two integers only.
double noiseAt(std::int64_t i, std::int64_t j) {
  auto hash =
      static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15ULL ^ static_cast<std::uint64_t>(j) * 0xC2B2AE3D27D4EB4FULL;
  hash ^= hash >> 31U;
  hash *= 0xBF58476D1CE4E5B9ULL;
  hash ^= hash >> 29U;
  return static_cast<double>(hash >> 11U) * 0x1p-52 - 1;
}

/// Grass: rough in patches of 0.5 m.
double grassAt(double x, double y) {
  return 0.03 * noiseAt(std::llround(std::floor(x / 0.5)), std::llround(std::floor(y / 0.5)));
}

struct MadeGround {
  std::map<TileKey, TilePoints> points;
  std::map<TileKey, GroundTile> ground;

  /// A point every 6 cm, with a laser's noise of up to 1 cm. `smooth` is the height without roughness.
  void addTile(TileKey key, const std::function<double(double, double)>& height,
               const std::function<double(double, double)>& smooth) {
    TilePoints& tile = points[key];
    tile.key = key;
    const Eigen::Vector3d corner = TileGrid().cornerOf(key);
    for (int j = 0; j < 266; ++j)
      for (int i = 0; i < 266; ++i) {
        const double x = (i + 0.5) * 0.06, y = (j + 0.5) * 0.06;
        tile.x.push_back(static_cast<float>(x));
        tile.y.push_back(static_cast<float>(y));
        const double noise = 0.01 * noiseAt(1000 * key.x + i, 1000 * key.y + j);
        tile.z.push_back(static_cast<float>(height(corner.x() + x, corner.y() + y) + noise));
      }
    GroundTile& cells = ground[key];
    cells.key = key;
    for (int i = 0; i < kStacksPerTile * kStacksPerTile; ++i) {
      const double x = (i % kStacksPerTile + 0.5) * kStackSize_m, y = (i / kStacksPerTile + 0.5) * kStackSize_m;
      cells.height.push_back(static_cast<float>(smooth(corner.x() + x, corner.y() + y)));
      cells.source.push_back(GroundSource::Measured);
    }
  }
  WayGraph ways() const {
    TileSet keys;
    for (const auto& [key, tile] : points) keys.insert(key);
    return waysOf(keys, [&](const TileKey& key) { return evenGroundOf(ringIn(points, key), ringIn(ground, key)); }, {});
  }
};

double slopeAt(double x, double) {
  return 100 + 0.05 * x;
}

MadeGround madeOf(const std::function<bool(double, double)>& is_paved) {
  MadeGround made;
  for (int y = -1; y <= 0; ++y)
    for (int x = -1; x <= 0; ++x)
      made.addTile(
          {x, y}, [&](double px, double py) { return slopeAt(px, py) + (is_paved(px, py) ? 0 : grassAt(px, py)); },
          slopeAt);
  return made;
}

TEST(Ways, TwoPathsOverGrassMeetInOneJunctionOfFourWays) {
  const WayGraph graph =
      madeOf([](double x, double y) { return std::abs(x + 1) < 1.5 || std::abs(y - 2) < 1.5; }).ways();
  ASSERT_EQ(graph.junctions.size(), 1U);
  EXPECT_LT((graph.junctions[0].place.head<2>() - Eigen::Vector2d(-1, 2)).norm(), 0.5);
  EXPECT_NEAR(graph.junctions[0].place.z(), slopeAt(-1, 2), 0.05);
  ASSERT_EQ(graph.ways.size(), 4U);
  double sum = 0;
  for (const Way& way : graph.ways) {
    EXPECT_NEAR(way.median_width_m, 3, 0.5);
    EXPECT_LE(way.least_width_m, way.median_width_m);
    EXPECT_EQ(way.junctions, (std::vector<std::size_t>{0}));
    EXPECT_EQ(way.lower_beside, 0);
    sum += way.length_m;
    const Eigen::Vector3d whole = way.line.back() - way.line.front();
    const bool is_along_slope = std::abs(whole.x()) > std::abs(whole.y());
    EXPECT_NEAR(way.steepest, is_along_slope ? 0.05 : 0, 0.025);
  }
  EXPECT_NEAR(sum, 64, 8) << "each path is 32 m long; lines end before the ends";
}

TEST(Ways, AKerbPartsASidewalkFromItsRoad) {
  MadeGround made;
  const auto smooth = [](double, double y) { return y < 1 ? 0.0 : 0.12; };
  const auto height = [&](double x, double y) { return smooth(x, y) + (y > -7 && y < 3.5 ? 0 : grassAt(x, y)); };
  for (int y = -1; y <= 0; ++y)
    for (int x = -1; x <= 0; ++x) made.addTile({x, y}, height, smooth);
  WayGraph graph = made.ways();
  ASSERT_EQ(graph.ways.size(), 2U);
  if (graph.ways[0].median_width_m > graph.ways[1].median_width_m) std::swap(graph.ways[0], graph.ways[1]);
  const Way &walk = graph.ways[0], &road = graph.ways[1];
  EXPECT_NEAR(walk.median_width_m, 2.5, 0.4);
  EXPECT_NEAR(road.median_width_m, 8, 0.5);
  EXPECT_GT(walk.lower_beside, 0.8);
  EXPECT_EQ(walk.higher_beside, 0);
  EXPECT_GT(road.higher_beside, 0.8);
  EXPECT_EQ(road.lower_beside, 0);
  EXPECT_NE(walk.region, road.region) << "a kerb is a step";
}

TEST(Ways, AStepAtTheEdgeOfARoadIsAKerb) {
  MadeGround made;
  const auto smooth = [](double x, double y) { return 0.02 * x + (y < 1 ? 0.0 : 0.12); };
  const auto height = [&](double x, double y) { return smooth(x, y) + (y > -7 && y < 3.5 ? 0 : grassAt(x, y)); };
  for (int y = -1; y <= 0; ++y)
    for (int x = -1; x <= 0; ++x) made.addTile({x, y}, height, smooth);
  const WayGraph graph = made.ways();
  ASSERT_EQ(graph.kerbs.size(), 1U);
  EXPECT_NEAR(graph.kerbs[0].length_m, 32, 2);
  EXPECT_NEAR(graph.kerbs[0].rise_m, 0.12, 0.02);
  for (const Eigen::Vector3d& p : graph.kerbs[0].line) EXPECT_NEAR(p.y(), 1, 0.25);
}

TEST(Ways, ABankBesideARoadIsNoKerb) {
  MadeGround made;
  const auto smooth = [](double, double y) { return std::clamp(y - 1, 0.0, 4.0) * 0.25; };
  const auto height = [&](double x, double y) { return smooth(x, y) + (y > -7 && y < 1 ? 0 : grassAt(x, y)); };
  for (int y = -1; y <= 0; ++y)
    for (int x = -1; x <= 0; ++x) made.addTile({x, y}, height, smooth);
  const WayGraph graph = made.ways();
  EXPECT_EQ(graph.ways.size(), 1U);
  EXPECT_TRUE(graph.kerbs.empty());
}

TEST(Ways, GrassAloneMakesNoWayButARegion) {
  const WayGraph graph = madeOf([](double, double) { return false; }).ways();
  EXPECT_TRUE(graph.ways.empty());
  ASSERT_EQ(graph.regions.size(), 1U);
  EXPECT_NEAR(graph.regions[0].area_m2, 32 * 32, 32);
}

TEST(Ways, AThingOnAPathMakesNoRing) {
  MadeGround made = madeOf([](double x, double) { return std::abs(x + 1) < 2; });
  for (auto& [key, tile] : made.points)
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const Eigen::Vector2d p = TileGrid().cornerOf(key).head<2>() + Eigen::Vector2d(tile.x[i], tile.y[i]);
      if ((p - Eigen::Vector2d(-1, 5)).norm() < 0.6) tile.z[i] += 1;
    }
  const WayGraph graph = made.ways();
  EXPECT_EQ(graph.ways.size(), 1U);
  EXPECT_TRUE(graph.junctions.empty());
}

TEST(Ways, DoNotDependOnTilesFarAway) {
  MadeGround made = madeOf([](double x, double y) { return std::abs(x + 1) < 1.5 || std::abs(y - 2) < 1.5; });
  const WayGraph alone = made.ways();
  for (const TileKey far : {TileKey{-40, 7}, TileKey{0, -30}, TileKey{9, 9}})
    made.addTile(
        far, [](double x, double y) { return grassAt(x, y); }, [](double, double) { return 0.0; });
  const WayGraph all = made.ways();
  ASSERT_EQ(all.ways.size(), alone.ways.size());
  for (std::size_t i = 0; i < all.ways.size(); ++i) {
    EXPECT_EQ(all.ways[i].line, alone.ways[i].line);
    EXPECT_EQ(all.ways[i].median_width_m, alone.ways[i].median_width_m);
  }
}

/// The lines of the canonical text about ways, junctions and regions.
std::string wayLines(const std::string& text) {
  std::string lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at) + 1;
    const std::string line = text.substr(at, end - at);
    for (const char* kind : {"/map/way/", "/map/junction/", "/map/region/"})
      if (line.find(kind) != std::string::npos) {
        lines += line;
        break;
      }
    at = end;
  }
  return lines;
}

TEST(Ways, OfAChangedMapAreThoseOfABuildFromScratch) {
  const SmallCampus campus({.seed = 7, .stops = 3, .size_m = 45, .points_per_stop = 15000});
  const MapInputs inputs = shippedInputs();
  const auto& files = campus.files();
  const std::string whole = builtText(files, inputs), two = builtText({files[0], files[2]}, inputs);
  ASSERT_NE(wayLines(whole).find("LINESTRING"), std::string::npos);
  ASSERT_NE(wayLines(whole), wayLines(two));
  EXPECT_EQ(builtText({files[2], files[0], files[1]}, inputs, {.threads = 2, .batch_points = 15000}), whole);

  const ScratchFolder folder;
  const auto map = folder.path() / "map.clx";
  buildMap(scansOf({files[0], files[2]}), inputs, map, {}, silence());
  extendMap(map, scansOf({files[1]}), {}, silence());
  EXPECT_EQ(canonicalText(map), whole);
  retractScans(map, {scansOf({files[1]}).load(0).id}, {}, silence());
  EXPECT_EQ(canonicalText(map), two);
}

}  // namespace
}  // namespace cluxel::mapping
