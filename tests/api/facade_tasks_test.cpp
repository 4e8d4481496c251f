// SPDX-License-Identifier: Apache-2.0
// Inventories and searches of the facade are those of the tasks.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "api/facade_campus.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/ask/inventory_task.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/search/search_tour.hpp"

namespace cluxel {
namespace {

using ::testing::HasSubstr;

const Map& campus() {
  return FacadeCampus::shared().map;
}

void expectSize(const std::optional<double>& size, double expected) {
  EXPECT_EQ(size.has_value(), !std::isnan(expected));
  EXPECT_EQ(size.value_or(0), std::isnan(expected) ? 0 : expected);
}

/// The kind of the error that `call` throws; StoreUnavailable when it throws none.
template <typename Call>
ErrorKind refusalOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()), "");
    return error.kind();
  }
  return ErrorKind::StoreUnavailable;
}

/// Expects the inventory of the task, and returns that of the facade.
Inventory expectedInventoryOf(const Map& map) {
  const mapping::MapReader reader(map.file());
  const tasks::Inventory expected = tasks::inventoryOf(reader, {});
  Inventory found = map.inventory();
  EXPECT_EQ(found.items.size(), expected.items.size());
  if (found.items.size() != expected.items.size()) return found;
  for (std::size_t i = 0; i < found.items.size(); ++i) {
    const InventoryItem& item = found.items[i];
    const tasks::InventoryItem& wanted = expected.items[i];
    EXPECT_EQ(item.kind, wanted.kind);
    EXPECT_EQ(item.class_iri, wanted.class_iri);
    EXPECT_EQ(item.object, wanted.object);
    EXPECT_EQ(Eigen::Vector2d(item.at.x, item.at.y), wanted.at);
    expectSize(item.height_m, wanted.height_m);
    expectSize(item.crown_m, wanted.crown_m);
    expectSize(item.width_m, wanted.width_m);
    expectSize(item.length_m, wanted.length_m);
    EXPECT_EQ(item.vehicle_count.value_or(1), wanted.count);
    EXPECT_EQ(item.vehicle_count.has_value(), item.kind == "ParkingRow");
    EXPECT_EQ(item.line.size(), wanted.line.size());
  }
  return found;
}

TEST(FacadeTasks, AnInventoryIsThatOfTheTask) {
  const Inventory found = expectedInventoryOf(campus());
  EXPECT_GT(found.items.size(), 5U);
  EXPECT_TRUE(std::any_of(found.items.begin(), found.items.end(), [](const auto& item) { return item.crown_m; }));
}

TEST(FacadeTasks, AnInventoryCountsTheVehiclesOfARow) {
  const rdf::ScratchFolder folder;
  const auto wall = [](double y) { return tasks::boxFrom({-15, y, 0}, {15, y + 0.5, 5}); };
  const auto car = [](double x) { return tasks::boxFrom({x, 4, 0.25}, {x + 4.2, 5.8, 1.5}); };
  tasks::writeVisits(
      {{{wall(10), wall(-12.5), car(-5), car(2), car(8.5)}, {{-3, 0, 1.8}, {1, -1, 1.8}, {5, 0, 1.8}, {8, 1, 1.8}}}},
      folder.path() / "scans");
  BuildOptions options = FacadeCampus::options();
  options.model.clear();  // the one that all data share knows these boxes
  const Inventory found =
      expectedInventoryOf(Map::build({folder.path() / "scans"}, folder.path() / "map.clx", options));
  std::vector<std::size_t> counts;
  for (const InventoryItem& item : found.items)
    if (item.vehicle_count) counts.push_back(*item.vehicle_count);
  EXPECT_THAT(counts, ::testing::ElementsAre(3U));
}

TEST(FacadeTasks, AnInventoryNamesStreetsAndTellsWhichLinesItPassesOver) {
  const rdf::ScratchFolder folder;
  const auto file = folder.path() / "streets.geojson";
  std::ofstream(file) << R"({"type": "FeatureCollection", "frame": "map", "features": [
    {"type": "Feature", "properties": {"name": "High Street"},
     "geometry": {"type": "LineString", "coordinates": [[-1000, 0], [1000, 0]]}},
    {"type": "Feature", "properties": {},
     "geometry": {"type": "LineString", "coordinates": [[0, 0], [1, 0]]}}]})";
  const Inventory trees = campus().inventory({.kinds = {"Tree"}, .streets = file});
  ASSERT_FALSE(trees.items.empty());
  std::size_t named = 0;
  for (const InventoryItem& item : trees.items) {
    EXPECT_EQ(item.kind, "Tree");
    EXPECT_EQ(item.street, std::abs(item.at.y) <= 25 ? "High Street" : "");
    named += item.street.empty() ? 0 : 1;
  }
  EXPECT_GT(named, 0U);
  ASSERT_FALSE(trees.notes.empty());
  EXPECT_THAT(trees.notes.front(),
              ::testing::EndsWith("streets.geojson: left out are features without a line: 0, without a name: 1"));
  EXPECT_TRUE(campus().inventory({.kinds = {"Tree"}}).items.front().street.empty());
}

TEST(FacadeTasks, AnInventoryRefusesWhatTheCommandRefuses) {
  EXPECT_EQ(refusalOf([] { campus().inventory({.kinds = {"Tre"}}); }), ErrorKind::NotFound);
  EXPECT_EQ(refusalOf([] { campus().inventory({.kinds = {"TreeTrunk"}}); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(refusalOf([] { campus().inventory({.streets = "absent.geojson"}); }), ErrorKind::FaultyInput);
}

GroundPosition placeOfAStop() {
  const Cloud cloud = campus().clouds().front();
  return {cloud.T_map_sensor[3], cloud.T_map_sensor[7]};
}

TEST(FacadeTasks, ASearchIsThatOfTheTask) {
  const mapping::MapReader reader(campus().file());
  const GroundPosition start = placeOfAStop();
  tasks::SearchRequest request;
  request.class_name = "StreetSign";
  char digits[80];
  std::snprintf(digits, sizeof digits, "%.17g,%.17g", start.x, start.y);
  request.from = digits;
  request.ways.params.width_m = 0.5;
  request.ways.without = {"Movable"};
  request.search.view_m = 8;
  request.tour.max_stops = 3;
  request.tour.budget_m = 60;
  const tasks::SearchAnswer expected = tasks::searchFor(reader, request);
  const SearchOptions options{
      .ground = {.without = {"Movable"}}, .width_m = 0.5, .start = start, .budget_m = 60, .max_stops = 3, .view_m = 8};
  const SearchTour found = campus().search("StreetSign", options);
  ASSERT_EQ(found.stops.size(), expected.stops.size());
  ASSERT_GT(found.stops.size(), 0U);
  for (std::size_t i = 0; i < found.stops.size(); ++i) {
    const SearchStop& stop = found.stops[i];
    const tasks::SearchStop& wanted = expected.stops[i];
    EXPECT_EQ(Eigen::Vector2d(stop.at.x, stop.at.y), expected.frame.centreOf(wanted.cell));
    EXPECT_EQ(stop.walk_m, wanted.walk_m);
    EXPECT_EQ(stop.total_m, wanted.total_m);
    EXPECT_EQ(stop.probability, wanted.probability);
    EXPECT_EQ(stop.so_far, wanted.so_far);
    EXPECT_EQ(stop.near_class, wanted.reason == tasks::kAnywhere ? "" : expected.reasons[wanted.reason]);
    ASSERT_FALSE(stop.way.empty());
    EXPECT_EQ(stop.way.back().x, stop.at.x);
  }
  ASSERT_EQ(found.known.size(), expected.known.size());
  for (std::size_t i = 0; i < found.known.size(); ++i) {
    EXPECT_EQ(found.known[i].iri, rdf::iriOfObject(reader.objectIds()[expected.known[i].object]));
    EXPECT_EQ(found.known[i].distance_m, expected.known[i].distance_m);
  }
  EXPECT_EQ(found.known.size(), campus().objects("StreetSign").size());
}

TEST(FacadeTasks, ASearchRefusesNumbersThatNoWalkHas) {
  const auto refused = [](SearchOptions options) {
    options.start = placeOfAStop();
    return refusalOf([&] { campus().search("Tree", options); });
  };
  EXPECT_EQ(refused({.width_m = -1}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.width_m = std::nan("")}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.budget_m = 0}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.budget_m = -1}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.budget_m = 1e7}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.max_stops = 0}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.max_stops = 101}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.view_m = 0.5}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.detection = 1.1}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.ground = {.max_slope = 11}}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.ground = {.max_step_m = 3}}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.ground = {.clearance_m = 0}}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.ground = {.cell_m = 0.3}}), ErrorKind::InvalidArgument);
  EXPECT_EQ(refused({.ground = {.without = {"Tre"}}}), ErrorKind::NotFound);
  EXPECT_EQ(refusalOf([] { campus().search("Tree", {.start = Place("")}); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(refusalOf([] {
              campus().search("Tree", {.start = GroundPosition{std::nan(""), 0}});
            }),
            ErrorKind::InvalidArgument);
  EXPECT_EQ(refusalOf([] { campus().search("Tree", {.start = "#999999"}); }), ErrorKind::NotFound);
  EXPECT_EQ(refusalOf([] { campus().search("Sidewalk", {.start = placeOfAStop()}); }), ErrorKind::InvalidArgument);
  try {
    campus().search("Tree", {});
    ADD_FAILURE() << "the scans have no times";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::NotFound);
    EXPECT_EQ(error.remedy(), Remedy::NameStart);
  }
}

}  // namespace
}  // namespace cluxel
