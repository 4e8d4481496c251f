// SPDX-License-Identifier: Apache-2.0
// Fields of probability and tours against brute force on small grids, and a search on a generated campus.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "mapping/change/map_update.hpp"
#include "mapping/ways/ways.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/search/search_field.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/ways/class_cells.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::tasks {
namespace {

PlaceEvidence evidence(const GridFrame& frame, std::uint32_t cell, double within_m, double probability) {
  PlaceEvidence place{"Thing", within_m, probability, LargeArray<std::uint8_t>(frame.size(), 0)};
  if (cell < frame.size()) place.is_there[cell] = 1;
  return place;
}

/// Everything is open.
PassableGrid plain(const GridFrame& frame) {
  TerrainGrid terrain;
  terrain.frame = frame;
  terrain.height.assign(frame.size(), 0.0F);
  terrain.seen.assign(frame.size(), 1);
  terrain.first_thing.assign(frame.size() + 1, 0);
  return passableOf(terrain, {}, {}, {});
}

SightGrid openSight(const GridFrame& frame) {
  return {frame, LargeArray<std::uint8_t>(frame.size(), 0)};
}

LargeArray<float> nothingKnown(const GridFrame& frame) {
  return LargeArray<float>(frame.size(), 0.0F);
}

TEST(SearchField, SpreadsEachPlaceAndTheRest) {
  const GridFrame frame{0, 0, 1, 5, 4};
  const SearchField field = fieldOf(frame, nothingKnown(frame), {evidence(frame, 0, 1, 0.6)});
  EXPECT_NEAR(std::accumulate(field.probability.begin(), field.probability.end(), 0.0), 1, 1e-12);
  EXPECT_NEAR(field.probability[frame.index(0, 0)], 0.6 / 3 + 0.4 / 20, 1e-12);
  EXPECT_NEAR(field.probability[frame.index(1, 0)], 0.6 / 3 + 0.4 / 20, 1e-12);
  EXPECT_NEAR(field.probability[frame.index(4, 3)], 0.4 / 20, 1e-12);
  EXPECT_EQ(field.reason[frame.index(0, 1)], 0);
  EXPECT_EQ(field.reason[frame.index(4, 3)], kAnywhere);
  const SearchField nothing = fieldOf(frame, nothingKnown(frame), {evidence(frame, 99, 1, 0.6)});
  for (const double value : nothing.probability) EXPECT_NEAR(value, 1.0 / 20, 1e-12);
  EXPECT_THROW(fieldOf(frame, nothingKnown(frame), {evidence(frame, 0, 1, 0.6), evidence(frame, 1, 1, 0.6)}), Error);
}

TEST(SearchField, WhatTheMapKnowsHoldsOnlyWhatWasOverlooked) {
  const GridFrame frame{0, 0, 1, 4, 1};
  const SearchField field = fieldOf(frame, {0.75F, 0, 0, 0.75F}, {});
  EXPECT_NEAR(field.probability[0] / field.probability[1], 0.25, 1e-12);
  EXPECT_EQ(fieldOf(frame, {1, 0, 0, 1}, {}).probability[3], 0);
  EXPECT_EQ(fieldOf(frame, {1, 1, 1, 1}, {}).probability[0], 0) << "all was seen, and nothing is overlooked";
}

TEST(SightGrid, WithoutObstaclesEveryCellOfTheDiscIsSeen) {
  const GridFrame frame{0, 0, 0.5, 40, 30};
  for (const double view_m : {0.4, 1.0, 3.3, 7.0}) {
    const std::uint32_t from = frame.index(20, 14);
    std::vector<std::uint32_t> disc;
    for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
      if ((frame.centreOf(cell) - frame.centreOf(from)).norm() <= view_m) disc.push_back(cell);
    EXPECT_EQ(visibleFrom(openSight(frame), from, view_m), disc) << view_m;
  }
}

TEST(SightGrid, ViewsFartherThanTheGridSeeAllOfIt) {
  const GridFrame frame{0, 0, 0.5, 40, 30};
  for (const double view_m : {30.0, 1e4, 1e9, 1e300})
    EXPECT_EQ(visibleFrom(openSight(frame), frame.index(3, 29), view_m).size(), frame.size()) << view_m;
}

TEST(SightGrid, IsSeenFromPlacesOutsideOfIt) {
  const GridFrame frame{0, 0, 1, 20, 20};
  SightGrid sight = openSight(frame);
  const Eigen::Vector2d outside(-5.5, 10.5);
  std::vector<std::uint32_t> disc;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
    if ((frame.centreOf(cell) - outside).norm() <= 12) disc.push_back(cell);
  EXPECT_EQ(visibleFrom(sight, outside, 12), disc);
  EXPECT_EQ(visibleFrom(sight, frame.centreOf(207), 6), visibleFrom(sight, 207U, 6)) << "the same inside";
  for (int y = 0; y < frame.rows; ++y) sight.opaque[frame.index(3, y)] = 1;
  for (const std::uint32_t cell : visibleFrom(sight, outside, 12)) EXPECT_LE(frame.columnOf(cell), 3);
  for (const double away : {-40.0, 1e12, -1e300, 1e300})
    EXPECT_TRUE(visibleFrom(sight, Eigen::Vector2d(away, 10), 12).empty()) << away;
}

TEST(SightGrid, AWallHidesWhatIsBehindItAndNothingElse) {
  const GridFrame frame{0, 0, 1, 21, 21};
  SightGrid sight = openSight(frame);
  for (int x = 0; x < frame.columns; ++x) sight.opaque[frame.index(x, 12)] = 1;
  std::size_t before = 0;
  for (const std::uint32_t cell : visibleFrom(sight, frame.index(10, 10), 8)) {
    EXPECT_LE(frame.rowOf(cell), 12);
    before += frame.rowOf(cell) < 12 ? 1 : 0;
  }
  std::size_t expected = 0;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
    expected += frame.rowOf(cell) < 12 && std::hypot(frame.columnOf(cell) - 10, frame.rowOf(cell) - 10) <= 8 ? 1 : 0;
  EXPECT_EQ(before, expected);
}

TEST(SearchTour, EachStopIsTheBestOfAllCellsForItsWalk) {
  std::mt19937 random(31);
  for (int round = 0; round < 20; ++round) {
    const GridFrame frame{0, 0, 1, 9, 8};
    const PassableGrid grid = plain(frame);
    SearchField field = fieldOf(frame, nothingKnown(frame), {});
    for (double& value : field.probability) value = static_cast<double>(random() % 100) / 10000;
    SearchParams search;
    search.view_m = 2;  // stops on every cell
    const TourParams params{.budget_m = 15, .max_stops = 4, .settle_m = 3, .looks_on_way = false};
    const auto stops = tourOf(grid, openSight(frame), field, {0.5, 0.5}, search, params);
    ASSERT_FALSE(stops.empty());
    std::uint32_t at = 0;
    double total_m = 0, so_far = 0;
    for (const SearchStop& stop : stops) {
      const LargeArray<double> walk_m = cheapestWays(grid, at, {.is_priced = false}).cost;
      double best = 0, here = 0;
      for (std::uint32_t cell = 0; cell < frame.size(); ++cell) {
        double gain = 0;
        for (std::uint32_t other = 0; other < frame.size(); ++other)
          if ((frame.centreOf(cell) - frame.centreOf(other)).norm() <= search.view_m) gain += field.probability[other];
        const double value = gain / (walk_m[cell] + params.settle_m);
        if (total_m + walk_m[cell] <= params.budget_m) best = std::max(best, value);
        if (cell == stop.cell) here = value;
      }
      EXPECT_NEAR(here, best, 1e-12);
      total_m += walk_m[stop.cell];
      so_far += stop.probability;
      EXPECT_NEAR(stop.total_m, total_m, 1e-9);
      ASSERT_FALSE(stop.way.empty());
      EXPECT_EQ(stop.way.front(), at);
      EXPECT_EQ(stop.way.back(), stop.cell);
      double along_m = 0;
      for (std::size_t i = 1; i < stop.way.size(); ++i)
        along_m += (frame.centreOf(stop.way[i]) - frame.centreOf(stop.way[i - 1])).norm();
      EXPECT_NEAR(along_m, stop.walk_m, 1e-9);
      EXPECT_NEAR(stop.so_far, so_far, 1e-12);
      EXPECT_LE(total_m, params.budget_m);
      for (std::uint32_t other = 0; other < frame.size(); ++other)
        if ((frame.centreOf(stop.cell) - frame.centreOf(other)).norm() <= search.view_m) field.probability[other] = 0;
      at = stop.cell;
    }
  }
}

TEST(WaysOfACampus, ASearchListsWhatIsKnownAndWhereToLook) {
  const MapReader& map = CampusMap::shared().map();
  SearchRequest request;
  request.class_name = "StreetLamp";
  EXPECT_THROW(searchFor(map, request), Error) << "no scan is the last";
  request.from = placeOfAStop(map);
  const SearchAnswer answer = searchFor(map, request);
  for (std::size_t i = 0; i < answer.known.size(); ++i) {
    EXPECT_EQ(localName(map.objects()[answer.known[i].object].class_iri), "StreetLamp");
    EXPECT_TRUE(i == 0 || answer.known[i - 1].distance_m <= answer.known[i].distance_m);
  }
  ASSERT_FALSE(answer.stops.empty());
  EXPECT_LE(answer.stops.back().so_far, 1 + 1e-9);
  request.class_name = "StreetLam";
  EXPECT_THROW(searchFor(map, request), Error);
  request.class_name = "TreeTrunk";
  try {
    searchFor(map, request);
    FAIL() << "trunks are parts";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is no class of objects"), std::string::npos) << error.what();
  }
}

/// Cells on the line of a way, found by another way than the program's: distances of all cells to its segments.
TEST(SearchField, FindsAWayWhereverItRuns) {
  const MapReader& map = CampusMap::shared().map();
  const TerrainGrid terrain = terrainOf(map);
  const auto marked = cellsWith(map, terrain, rdf::vocabulary::clx("Way"), goneAmong(map));
  const WayGraph ways = map.ways();
  ASSERT_FALSE(ways.ways.empty());
  std::size_t on_line = 0;
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell) {
    double nearest = 1e300;
    for (const Way& way : ways.ways)
      for (std::size_t i = 1; i < way.line.size(); ++i) {
        const Eigen::Vector2d a = way.line[i - 1].head<2>(), b = way.line[i].head<2>(),
                              p = terrain.frame.centreOf(cell);
        const double along = std::clamp((p - a).dot(b - a) / std::max(1e-12, (b - a).squaredNorm()), 0.0, 1.0);
        nearest = std::min(nearest, (a + along * (b - a) - p).norm());
      }
    if (nearest < 0.2 * terrain.frame.cell_m) {
      ++on_line;
      EXPECT_EQ(marked[cell], 1) << "the line runs through the middle of cell " << cell;
    }
    if (nearest > 0.8 * terrain.frame.cell_m) {
      EXPECT_EQ(marked[cell], 0);
    }
  }
  EXPECT_GT(on_line, 20U);
}

TEST(SearchField, FindsALineThatRunsFarBeyondTheMap) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "map.clx";
  std::filesystem::copy_file(CampusMap::shared().file(), file);
  updateMap(file,
            "PREFIX geo: <http://www.opengis.net/ont/geosparql#> INSERT DATA { <http://e.x/way> a <http://e.x/Far> ; "
            "geo:hasGeometry <http://e.x/line> . <http://e.x/line> geo:asWKT "
            "\"MULTILINESTRING ((-1e12 1.1, 1e12 1.1), (1.1 1e9, 2.1 1e9))\"^^geo:wktLiteral }",
            {}, silence());
  const MapReader map(file);
  const TerrainGrid terrain = terrainOf(map);
  const auto marked = cellsWith(map, terrain, "http://e.x/Far", goneAmong(map));
  const auto row = static_cast<int>((1.1 - terrain.frame.min_y) / terrain.frame.cell_m);
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    ASSERT_EQ(marked[cell] == 1, terrain.frame.rowOf(cell) == row) << "cell " << cell;
}

}  // namespace
}  // namespace cluxel::tasks
