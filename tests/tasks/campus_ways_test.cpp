// SPDX-License-Identifier: Apache-2.0
// Ways over a generated campus: what closes cells is what stands there.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::tasks {
namespace {

TEST(WaysOfACampus, ThingsLieInTheBoxesOfTheirObjects) {
  const MapReader& map = CampusMap::shared().map();
  const TerrainGrid terrain = terrainOf(map);
  const auto boxes = CampusMap::shared().boxesInRdf();
  std::size_t checked = 0;
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell)) {
      if (thing == kUnnamedThing) continue;
      const Eigen::AlignedBox3d& box = boxes.at(map.objects()[thing].id.hex());
      const Eigen::Vector2d centre = terrain.frame.centreOf(cell);
      const double reach_m = terrain.frame.cell_m;
      EXPECT_GT(centre.x(), box.min().x() - reach_m);
      EXPECT_GT(centre.y(), box.min().y() - reach_m);
      EXPECT_LT(centre.x(), box.max().x() + reach_m);
      EXPECT_LT(centre.y(), box.max().y() + reach_m);
      ++checked;
    }
  EXPECT_GT(checked, 100U);
}

/// The ground is told without the feet of what is left out. So a few cells may turn out to be steep, close to it.
TEST(WaysOfACampus, LeavingThingsOutOpensCellsAndClosesNoneButSteepOnesNearThem) {
  constexpr double kNear_m = 1.25;
  const MapReader& map = CampusMap::shared().map();
  WayRequest request;
  const PassableGrid with = passableIn(map, request);
  request.without = {"Movable"};
  const PassableGrid without = passableIn(map, request);
  const std::vector<bool> is_left_out = leftOut(map, request);
  const TerrainGrid terrain = terrainIn(map, request);
  LargeArray<std::uint8_t> stood(terrain.frame.size(), 0);
  for (std::uint32_t cell = 0; cell < stood.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && is_left_out[thing]) stood[cell] = 1;
  const NearestMarked nearest = nearestMarked(terrain.frame, stood);
  std::size_t opened = 0, closed = 0;
  for (std::uint32_t cell = 0; cell < with.frame.size(); ++cell) {
    const bool was_open = with.closure[cell] == Closure::Open, is_open = without.closure[cell] == Closure::Open;
    opened += is_open && !was_open ? 1 : 0;
    if (is_open || !was_open) continue;
    EXPECT_EQ(without.closure[cell], Closure::TooSteep);
    EXPECT_LE(nearest.distance[cell] * terrain.frame.cell_m, kNear_m);
    ++closed;
  }
  EXPECT_GT(opened, 50 * closed);
}

TEST(WaysOfACampus, AMobilityIsWrittenAsAClassIs) {
  const auto without = [](const std::string& name) {
    WayRequest request;
    request.without = {name};
    return leftOut(CampusMap::shared().map(), request);
  };
  const std::vector<bool> movable = without("Movable");
  EXPECT_NE(movable, without("Static"));
  for (const char* name : {"movable", "MOVABLE", "clx:Movable", "https://w3id.org/cluxel/ontology#Movable"})
    EXPECT_EQ(without(name), movable) << name;
}

TEST(WaysOfACampus, PlacesOutsideOfTheMapAreNamedShortly) {
  const PassableGrid grid = passableIn(CampusMap::shared().map(), {});
  for (const auto& [place, text] :
       {std::pair(Eigen::Vector2d(1e300, 0), "(1e300, 0)"), {Eigen::Vector2d(-2500.25, 5000), "(-2500.2, 5000)"}})
    try {
      openCellNear(grid, place);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
}

TEST(WaysOfACampus, RoutesStayOnOpenCellsAndAreReported) {
  const MapReader& map = CampusMap::shared().map();
  const PassableGrid grid = passableIn(map, {});
  std::uint32_t from = 0;
  while (grid.closure[from] != Closure::Open) ++from;
  const LargeArray<double> walk_m = walkLengths(grid, grid.frame.centreOf(from), 1e6);
  std::uint32_t to = from;
  for (std::uint32_t cell = 0; cell < walk_m.size(); ++cell)
    if (std::isfinite(walk_m[cell]) && walk_m[cell] > walk_m[to]) to = cell;
  const RouteAnswer answer = findRoutes(grid, grid.frame.centreOf(from), grid.frame.centreOf(to), 1);
  ASSERT_EQ(answer.routes.size(), 1U);
  EXPECT_GE(answer.routes[0].length_m, walk_m[to] - 1e-6) << "the shortest walk is not longer";
  for (const std::uint32_t cell : answer.routes[0].cells) EXPECT_EQ(grid.closure[cell], Closure::Open);
  const std::string line = routesGeoJson(map, grid.frame, answer, ExportFrame::Local);
  EXPECT_NE(line.find("LineString"), std::string::npos);
  EXPECT_NE(routesJson(map, grid.frame, answer).find("\"barriers\": []"), std::string::npos);
}

TEST(WaysOfACampus, StayNearObjectsPlacesAndWays) {
  const MapReader& map = CampusMap::shared().map();
  const PassableGrid plain = passableIn(map, {});
  const auto shareOfDearCells = [&](const std::string& near) {
    WayRequest request;
    request.near = near;
    const PassableGrid grid = passableIn(map, request);
    std::size_t dear = 0;
    for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell) {
      const double times = static_cast<double>(grid.factor[cell]) / static_cast<double>(plain.factor[cell]);
      EXPECT_TRUE(std::abs(times - 1) < 1e-5 || std::abs(times - 3) < 1e-5) << times;
      dear += times > 2 ? 1 : 0;
    }
    return static_cast<double>(dear) / static_cast<double>(grid.frame.size());
  };
  for (const char* near : {"Tree", "Static", "Way"}) {
    EXPECT_GT(shareOfDearCells(near), 0) << near;
    EXPECT_LT(shareOfDearCells(near), 1) << near;
  }
  EXPECT_LT(shareOfDearCells("Ground"), shareOfDearCells("Tree")) << "one walks on it";
  WayRequest request;
  request.near = "Derivation";
  EXPECT_THROW(passableIn(map, request), Error) << "it has no place";
}

TEST(WaysOfACampus, NamesAreThoseOfTheMap) {
  const MapReader& map = CampusMap::shared().map();
  EXPECT_EQ(placeNamed(map, "1.5,-2"), Eigen::Vector2d(1.5, -2));
  const std::string hash = map.objects()[0].id.hex();
  EXPECT_EQ(placeNamed(map, "#0"), placeNamed(map, hash));
  EXPECT_EQ(placeNamed(map, rdf::iriOfObject(map.objects()[0].id)), placeNamed(map, hash));
  for (const std::string& written :
       {"map:object/" + hash, "object/" + hash.substr(0, 12), "<" + rdf::iriOfObject(map.objects()[0].id) + ">"})
    EXPECT_EQ(placeNamed(map, written), placeNamed(map, hash)) << written;
  EXPECT_THROW(placeNamed(map, "primitive/" + hash), Error);
  for (const char* bad : {"#100000", "1,x", "abc", "", "ffffffffffff"})
    EXPECT_THROW(placeNamed(map, bad), Error) << bad;
  WayRequest request;
  request.without = {"Vehicel"};
  try {
    passableIn(map, request);
    ADD_FAILURE() << "an unknown class";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("Vehicle"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace cluxel::tasks
