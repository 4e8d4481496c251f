// SPDX-License-Identifier: Apache-2.0
// Ground on which something stood that is gone, or that is left out, is as open as if no ray had met it.
#include <gtest/gtest.h>

#include <set>

#include "rdf/vocabulary.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/ways/cost_map.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {
namespace {

/// Three cars whose bodies reach down to the ground on the first visit, of which one has left on the second.
class WaysOverGoneThings : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Box north = boxFrom({-15, 10, 0}, {15, 10.5, 5}), south = boxFrom({-15, -12.5, 0}, {15, -12, 5});
    const Box stays = boxFrom({-5, 4, 0.05}, {-0.8, 5.8, 1.5}), stays_too = boxFrom({8.5, 4, 0.05}, {12.7, 5.8, 1.5});
    const std::vector<Box> rest{north, south, stays, stays_too};
    std::vector<Box> all = rest;
    all.push_back(kLeaves);
    const std::vector<Eigen::Vector3d> sensors{{-3, 0, 1.8}, {1, -1, 1.8}, {5, 0, 1.8}, {8, 1, 1.8}};
    folder = new rdf::ScratchFolder;
    with.emplace(mapOf("with", {{all, sensors}, {rest, sensors}}));
    without.emplace(mapOf("without", {{rest, sensors, {kLeaves}}, {rest, sensors}}));
  }
  static void TearDownTestSuite() {
    with.reset(), without.reset();
    delete folder;
  }
  static mapping::MapReader mapOf(const std::string& name, const std::vector<BoxVisit>& visits) {
    const auto map = folder->path() / (name + ".clx");
    writeVisits(visits, folder->path() / name);
    mapping::buildMap(mapping::scansOf({folder->path() / name}), mapping::shippedInputs(), map, {}, mapping::silence());
    return mapping::MapReader(map);
  }
  /// Cells of the frame around both sides of the car that left, a metre around it.
  static WayRequest request() {
    WayRequest request;
    request.params.width_m = 0;
    request.terrain.area = Eigen::AlignedBox2d(kLeaves.min().head<2>(), kLeaves.max().head<2>());
    request.terrain.area->min() -= Eigen::Vector2d::Ones(), request.terrain.area->max() += Eigen::Vector2d::Ones();
    return request;
  }
  static void expectAsWithoutIt(const WayRequest& request) {
    const PassableGrid grid = passableIn(*with, request), oracle = passableIn(*without, WaysOverGoneThings::request());
    ASSERT_EQ(grid.frame.size(), oracle.frame.size());
    for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell) {
      EXPECT_EQ(grid.closure[cell], oracle.closure[cell]) << grid.frame.centreOf(cell).transpose();
      EXPECT_EQ(isBesideStep(grid, cell), isBesideStep(oracle, cell)) << grid.frame.centreOf(cell).transpose();
    }
  }

  inline static const Box kLeaves = boxFrom({2, 4, 0.05}, {6.2, 5.8, 1.5});
  inline static rdf::ScratchFolder* folder = nullptr;
  inline static std::optional<mapping::MapReader> with, without;
};

TEST_F(WaysOverGoneThings, AreThoseOfAMapWithoutTheirPoints) {
  const std::vector<bool> is_gone = goneAmong(*with);
  ASSERT_EQ(std::count(is_gone.begin(), is_gone.end(), true), 1);
  ASSERT_EQ(goneAmong(*without), std::vector<bool>(without->objects().size()));
  expectAsWithoutIt(request());
}

TEST_F(WaysOverGoneThings, AreClosedByThemOnRequest) {
  WayRequest kept = request();
  kept.with_gone = true;
  const PassableGrid grid = passableIn(*with, kept);
  const auto middle = grid.frame.cellAt(kLeaves.center().head<2>());
  EXPECT_GT(std::count(grid.closure.begin(), grid.closure.end(), Closure::Obstacle), 20);
  ASSERT_TRUE(middle);
  kept.without = {"Vehicle"};
  expectAsWithoutIt(kept);
}

/// A thing that is lower than obstacles are stays a step, and ground stays ground whatever is left out.
TEST_F(WaysOverGoneThings, HaveTheHeightOfWhatIsThere) {
  const TerrainParams params = request().terrain;
  const TerrainGrid all = terrainOf(*with, params, {});
  std::vector<bool> every(with->objects().size(), true);
  const TerrainGrid ground = terrainOf(*with, params, every);
  EXPECT_EQ(all.first_thing, ground.first_thing) << "the things are named whatever is left out";
  std::size_t higher = 0;
  for (std::uint32_t cell = 0; cell < all.frame.size(); ++cell) {
    EXPECT_LT(std::abs(ground.height[cell]), 0.03F) << all.frame.centreOf(cell).transpose();
    higher += all.height[cell] > 0.05F ? 1 : 0;
  }
  EXPECT_GT(higher, 0U) << "the foot of the car, where it counts";
}

}  // namespace
}  // namespace cluxel::tasks
