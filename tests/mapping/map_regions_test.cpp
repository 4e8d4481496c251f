// SPDX-License-Identifier: Apache-2.0
// Regions say of their cluxels, objects and points what the whole map says.
#include "mapping/regions/map_regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

class MapRegionsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder();
    const SmallCampus campus({.seed = 5, .stops = 6, .size_m = 80, .points_per_stop = 7000, .max_range_m = 16});
    buildMap(scansOf(campus.files()), shippedInputs(), folder->path() / "street.clx", {}, silence());
    map = new MapReader(folder->path() / "street.clx");
  }
  static void TearDownTestSuite() {
    delete map;
    delete folder;
  }

  static inline ScratchFolder* folder = nullptr;
  static inline MapReader* map = nullptr;
};

TEST_F(MapRegionsTest, HoldEachCluxelOnceAsTheSceneHasIt) {
  const perception::SceneCluxels& all = map->scene().cluxels;
  const std::vector<std::uint32_t> object_of = objectOfCluxel({map->objects(), {}}, all.size());
  for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{2000}, all.size()}) {
    MapRegions regions(*map, max_cluxels);
    std::vector<int> seen(all.size(), 0);
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const MapRegion region = regions.read(i);
      EXPECT_TRUE(std::is_sorted(region.number.begin(), region.number.end()));
      for (std::uint32_t c = 0; c < region.number.size(); ++c) {
        if (!region.is_own[c]) continue;
        const std::uint32_t number = region.number[c];
        ++seen[number];
        EXPECT_EQ(region.object[c], object_of[number]);
        EXPECT_EQ(region.scene.cluxels.center[c], all.center[number]);
        EXPECT_EQ(region.scene.cluxels.height_above_ground[c], all.height_above_ground[number]);
        std::vector<std::uint32_t> neighbours;
        for (const std::uint32_t other : region.scene.cluxels.neighbours(c)) neighbours.push_back(region.number[other]);
        const auto expected = all.neighbours(number);
        EXPECT_TRUE(std::equal(neighbours.begin(), neighbours.end(), expected.begin(), expected.end()));
      }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(all.size())) << max_cluxels;
  }
}

TEST_F(MapRegionsTest, HoldEachObjectWholeInOneOfThem) {
  MapRegions regions(*map, 1);
  std::map<std::uint32_t, std::vector<std::uint32_t>> cluxels;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const MapRegion region = regions.read(i);
    for (std::size_t k = 0; k < region.objects.size(); ++k) {
      std::vector<std::uint32_t>& numbers = cluxels[region.number_of_objects[k]];
      EXPECT_TRUE(numbers.empty());
      for (const std::uint32_t c : cluxelsOf(region.objects[k])) numbers.push_back(region.number[c]);
    }
  }
  std::size_t across = 0;
  for (std::uint32_t i = 0; i < map->objects().size(); ++i) {
    if (regions.isGround(i)) {
      EXPECT_FALSE(cluxels.contains(i));
      continue;
    }
    EXPECT_EQ(cluxels[i], cluxelsOf(map->objects()[i]));
    const auto tileOf = [&](std::uint32_t c) { return map->scene().cluxels.name[c].tile; };
    across += tileOf(cluxels[i].front()) != tileOf(cluxels[i].back()) ? 1 : 0;
  }
  EXPECT_GE(across, 1) << "the campus has no object that lies in two tiles";
}

TEST_F(MapRegionsTest, GiveEachPointTheCluxelThatTheMapGivesIt) {
  MapRegions regions(*map, 2000);
  ASSERT_GT(regions.size(), 1);
  std::map<std::string, std::map<std::size_t, std::uint32_t>> got, expected;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const MapRegion region = regions.read(i);
    for (const Cloud& cloud : map->clouds())
      regions.forEachPoint(region, cloud, [&](const Eigen::Vector3d& p_map, std::uint32_t cluxel, std::size_t point) {
        EXPECT_TRUE(region.tiles.contains(perception::TileGrid().tileOf(p_map)));
        EXPECT_TRUE(got[cloud.id.hex()].emplace(point, region.number[cluxel]).second) << "was visited before";
      });
  }
  for (const Cloud& cloud : map->clouds()) {
    const std::vector<std::uint32_t> cluxels = map->answersFor(cloud).cluxel;
    for (std::size_t point = 0; point < cluxels.size(); ++point) expected[cloud.id.hex()][point] = cluxels[point];
  }
  EXPECT_EQ(got, expected);
}

}  // namespace
}  // namespace cluxel::mapping
