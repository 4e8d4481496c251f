// SPDX-License-Identifier: Apache-2.0
// Routes and cost maps of the facade are those of the tasks.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <thread>

#include "api/facade_campus.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/ways/cost_map.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel {
namespace {

class FacadeWays : public ::testing::Test {
 protected:
  static GroundPosition stop(std::size_t number) {
    const Cloud cloud = map().clouds()[number];
    return {cloud.T_map_sensor[3], cloud.T_map_sensor[7]};
  }
  static Eigen::Vector2d at(const GroundPosition& position) { return {position.x, position.y}; }
  static const Map& map() { return FacadeCampus::shared().map; }

  const mapping::MapReader reader{map().file()};
};

void expectLine(const std::vector<GroundPosition>& line, const std::vector<Eigen::Vector2d>& expected) {
  ASSERT_EQ(line.size(), expected.size());
  for (std::size_t i = 0; i < line.size(); ++i) EXPECT_EQ(Eigen::Vector2d(line[i].x, line[i].y), expected[i]);
}

TEST_F(FacadeWays, RoutesAreThoseOfTheTask) {
  tasks::WayRequest request;
  request.params.width_m = 0.4;
  request.params.max_slope = 0.3;
  request.params.max_step_m = 0.2;
  request.terrain.highest_m = 1.5;
  request.terrain.cell_m = 0.5;
  request.without = {"Movable"};
  request.near = "Tree";
  const RouteOptions options{
      .ground = {.max_slope = 0.3, .max_step_m = 0.2, .clearance_m = 1.5, .cell_m = 0.5, .without = {"Movable"}},
      .width_m = 0.4,
      .near = "Tree",
      .alternatives = 3};
  const tasks::PassableGrid grid = passableIn(reader, request);
  const tasks::RouteAnswer expected = findRoutes(grid, at(stop(0)), at(stop(1)), 3);
  const Routes found = map().routes(stop(0), stop(1), options);
  ASSERT_EQ(found.routes.size(), expected.routes.size());
  ASSERT_GT(found.routes.size(), 1U);
  for (std::size_t i = 0; i < found.routes.size(); ++i) {
    const Route& route = found.routes[i];
    const tasks::Route& wanted = expected.routes[i];
    expectLine(route.line, tasks::cornersOf(grid.frame, wanted.cells));
    EXPECT_EQ(route.length_m, wanted.length_m);
    EXPECT_EQ(route.cost, wanted.cost);
    EXPECT_EQ(route.climb_m, wanted.climb_m);
    EXPECT_EQ(route.steepest, wanted.steepest);
    EXPECT_EQ(route.highest_step_m, wanted.highest_step_m);
    EXPECT_EQ(route.narrowest_m.value_or(INFINITY), wanted.narrowest_m);
  }
  EXPECT_TRUE(found.barriers.empty());
}

BarrierKind kindOf(tasks::Barrier::Kind kind) {
  const std::map<tasks::Barrier::Kind, BarrierKind> kinds{{tasks::Barrier::Kind::Unobserved, BarrierKind::Unobserved},
                                                          {tasks::Barrier::Kind::Obstacle, BarrierKind::Thing},
                                                          {tasks::Barrier::Kind::TooSteep, BarrierKind::TooSteep},
                                                          {tasks::Barrier::Kind::TooNarrow, BarrierKind::TooNarrow},
                                                          {tasks::Barrier::Kind::Step, BarrierKind::Step}};
  return kinds.at(kind);
}

void expectBarriers(const mapping::MapReader& reader, const std::vector<Barrier>& found,
                    const std::vector<tasks::Barrier>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].kind, kindOf(expected[i].kind));
    EXPECT_EQ(found[i].text, tasks::barrierText(reader, expected[i]));
    EXPECT_EQ(Eigen::Vector2d(found[i].at.x, found[i].at.y), expected[i].at);
    EXPECT_EQ(found[i].length_m, expected[i].length_m);
    EXPECT_EQ(found[i].measured.value_or(0), expected[i].measured);
    const bool is_named = expected[i].thing != tasks::kUnnamedThing;
    EXPECT_EQ(found[i].object, is_named ? rdf::iriOfObject(reader.objectIds()[expected[i].thing]) : "");
  }
}

TEST_F(FacadeWays, WhatClosesAWayIsThatOfTheTask) {
  const RouteOptions options{.ground = {.max_step_m = 0.02}, .width_m = 1};
  tasks::WayRequest request;
  request.params.width_m = 1, request.params.max_step_m = 0.02;
  const tasks::PassableGrid grid = passableIn(reader, request);
  std::set<BarrierKind> kinds;
  for (std::uint32_t goal = 0; goal < grid.frame.size() && kinds.size() < 2; goal += 487) {
    if (grid.closure[goal] != tasks::Closure::Open) continue;
    const Eigen::Vector2d place = grid.frame.centreOf(goal);
    const tasks::RouteAnswer expected = findRoutes(grid, at(stop(0)), place, 1);
    if (!expected.routes.empty()) continue;
    const Routes found = map().routes(stop(0), GroundPosition{place.x(), place.y()}, options);
    EXPECT_TRUE(found.routes.empty());
    expectBarriers(reader, found.barriers, expected.barriers);
    for (const Barrier& barrier : found.barriers) kinds.insert(barrier.kind);
  }
  EXPECT_EQ(kinds.size(), 2U);
}

TEST_F(FacadeWays, PlacesAreObjectsToo) {
  const Object tree = map().objects("Tree").front();
  const RouteOptions options{.ground = {.without = {"Tree"}}};
  const Routes by_iri = map().routes(stop(0), tree.iri, options),
               by_number = map().routes(stop(0), "#" + std::to_string(tree.number), options),
               by_place = map().routes(stop(0), GroundPosition{tree.centroid.x, tree.centroid.y}, options);
  ASSERT_EQ(by_iri.routes.size(), by_place.routes.size());
  ASSERT_EQ(by_number.routes.size(), by_place.routes.size());
  for (std::size_t i = 0; i < by_place.routes.size(); ++i) {
    EXPECT_EQ(by_iri.routes[i].length_m, by_place.routes[i].length_m);
    EXPECT_EQ(by_number.routes[i].length_m, by_place.routes[i].length_m);
  }
}

/// The pixels of the image of the command, in which the row with the largest y is the first.
TEST_F(FacadeWays, ACostMapHasTheGreyValuesOfTheImage) {
  const GroundOptions options{.max_step_m = 0.1, .cell_m = 0.5, .without = {"Movable"}};
  tasks::WayRequest request;
  request.params.max_step_m = 0.1, request.terrain.cell_m = 0.5, request.without = {"Movable"};
  request.params.width_m = 0;
  const tasks::PassableGrid grid = passableIn(reader, request);
  const tasks::CostMap expected = costMapOf(grid, "ground.pgm");
  const CostMap found = map().costMap(options);
  EXPECT_EQ(found.min_x, grid.frame.min_x);
  EXPECT_EQ(found.min_y, grid.frame.min_y);
  EXPECT_EQ(found.cell_m, 0.5);
  ASSERT_EQ(found.cells.size(), found.columns * found.rows);
  const std::string header = "P5\n" + std::to_string(found.columns) + " " + std::to_string(found.rows) + "\n255\n";
  ASSERT_EQ(expected.image.substr(0, header.size()), header);
  const std::string pixels = expected.image.substr(header.size());
  ASSERT_EQ(pixels.size(), found.cells.size());
  std::set<GroundKind> kinds;
  for (std::size_t row = 0; row < found.rows; ++row)
    for (std::size_t column = 0; column < found.columns; ++column) {
      const GroundKind kind = found.cells[row * found.columns + column];
      const auto grey = static_cast<unsigned char>(pixels[(found.rows - 1 - row) * found.columns + column]);
      ASSERT_EQ(grey, kind == GroundKind::Free ? 254 : kind == GroundKind::Unobserved ? 205 : 0);
      const auto cell = static_cast<std::uint32_t>(row * found.columns + column);
      ASSERT_EQ(kind == GroundKind::Thing, grid.closure[cell] == tasks::Closure::Obstacle);
      ASSERT_EQ(kind == GroundKind::TooSteep, grid.closure[cell] == tasks::Closure::TooSteep);
      kinds.insert(kind);
    }
  EXPECT_GE(kinds.size(), 3U);
}

TEST_F(FacadeWays, ManyThreadsAskAtOnce) {
  const CostMap ground = map().costMap();
  const double length_m = map().routes(stop(0), stop(1)).routes.at(0).length_m;
  std::atomic<int> right = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      const bool is_same = i % 2 == 0 ? map().costMap().cells == ground.cells
                                      : map().routes(stop(0), stop(1)).routes.at(0).length_m == length_m;
      right += is_same ? 1 : 0;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 4);
}

TEST_F(FacadeWays, NumbersOutOfRangeAreRefused) {
  const auto kindOf = [](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      return std::optional(error.kind());
    }
    return std::optional<ErrorKind>();
  };
  const GroundPosition here = stop(0);
  for (const std::size_t alternatives : {0U, 10U})
    EXPECT_EQ(kindOf([&] { map().routes(here, here, {.alternatives = alternatives}); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { map().routes(here, here, {.width_m = 21}); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { map().routes(here, "1,2,3"); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { map().routes("no such thing", here); }), ErrorKind::NotFound);
  EXPECT_EQ(kindOf([&] { map().routes(here, GroundPosition{1e5, 0}); }), ErrorKind::NotFound);
  EXPECT_EQ(kindOf([&] { map().costMap({.cell_m = 1e-3}); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { map().costMap({.max_slope = -0.1}); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { map().costMap({.without = {"Tre"}}); }), ErrorKind::NotFound);
}

}  // namespace
}  // namespace cluxel
