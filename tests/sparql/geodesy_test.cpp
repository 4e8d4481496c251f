// SPDX-License-Identifier: Apache-2.0
// Tests of distances in named coordinate systems: along the ellipsoid, in other units, or none with a note.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "base/proj_reference_system.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/geometry/geometry.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::HasSubstr;

const std::string kCrs84 = "<http://www.opengis.net/def/crs/OGC/1.3/CRS84> ";
const std::string kEpsg4326 = "<http://www.opengis.net/def/crs/EPSG/0/4326> ";
const std::string kFeet = "<http://www.opengis.net/def/crs/EPSG/0/2263> ";

double metres(const std::string& a, const std::string& b) {
  const SmallStore store;
  const QueryResult result =
      store.ask("SELECT (geof:distance(\"" + a + "\"^^geo:wktLiteral, \"" + b + "\"^^geo:wktLiteral) AS ?d) {}");
  const Term* distance = result.table.at(0, 0);
  return distance == nullptr ? -1 : std::stod(distance->text);
}

std::vector<std::string> notesOn(const std::string& expression) {
  const SmallStore store;
  const QuadReader reader = store.reader();
  PreparedQuery query(reader, kPrefixes + "SELECT (" + expression + " AS ?d) {}");
  query.evaluate();
  std::vector<std::string> texts;
  for (const Diagnostic& note : query.notes()) texts.push_back(note.message);
  return texts;
}

std::string distanceCall(const std::string& a, const std::string& b) {
  return "geof:distance(\"" + a + "\"^^geo:wktLiteral, \"" + b + "\"^^geo:wktLiteral)";
}

/// The reference is the example of GeographicLib's documentation, from New York to London.
TEST(Geodesy, MeasuresAlongTheEllipsoidInTheAxisOrderOfTheSystem) {
  EXPECT_NEAR(metres(kCrs84 + "POINT(-73.8 40.6)", kCrs84 + "POINT(-0.5 51.6)"), 5551759.400, 0.001);
  EXPECT_NEAR(metres(kEpsg4326 + "POINT(40.6 -73.8)", kEpsg4326 + "POINT(51.6 -0.5)"), 5551759.400, 0.001);
  EXPECT_NEAR(metres(kCrs84 + "POINT(179.9995 0)", kCrs84 + "POINT(-179.9995 0)"), 111.319, 0.001) << "0.001 degrees";
  EXPECT_EQ(metres(kCrs84 + "POINT(8 50)", kCrs84 + "POINT(8 50)"), 0);
}

TEST(Geodesy, MeasuresProjectedSystemsByTheirUnit) {
  EXPECT_NEAR(metres(kFeet + "POINT(0 0)", kFeet + "POINT(300 400)"), 500 * 1200.0 / 3937, 1e-9) << "survey feet";
  EXPECT_EQ(metres("<http://www.opengis.net/def/crs/EPSG/0/25832> POINT(0 0)",
                   "<http://www.opengis.net/def/crs/EPSG/0/25832> POINT(3 4)"),
            5);
}

/// Lines are sampled densely; the nearest sample is not nearer than the line, and hardly farther.
TEST(Geodesy, FindsTheNearestPointsOfLinesAndAreas) {
  const ReferenceSystem system = referenceSystem(kCrs84.substr(0, kCrs84.size() - 1));
  ASSERT_EQ(system.kind, ReferenceSystem::Kind::Geographic);
  std::mt19937 random(7);
  const auto degrees = [&random](double around) { return around + static_cast<double>(random() % 20'000) * 1e-6; };
  for (int run = 0; run < 20; ++run) {
    const double x = degrees(8.68), y0 = degrees(50.1), y1 = degrees(50.1), px = degrees(8.71), py = degrees(50.1);
    const auto line = parseWkt("LINESTRING(" + std::to_string(x) + " " + std::to_string(y0) + ", " + std::to_string(x) +
                               " " + std::to_string(y1) + ")");
    const auto point = parseWkt("POINT(" + std::to_string(px) + " " + std::to_string(py) + ")");
    const auto area = parseWkt("POLYGON((" + std::to_string(px) + " " + std::to_string(py) + ", 9 50, 9 50.2, " +
                               std::to_string(px) + " " + std::to_string(py) + "))");
    double nearest_m = 1e9;
    for (int i = 0; i <= 2000; ++i) {
      const auto sample =
          parseWkt("POINT(" + std::to_string(x) + " " + std::to_string(y0 + (y1 - y0) * i / 2000) + ")");
      nearest_m = std::min(nearest_m, *geodesicDistance(*sample, *point, system));
    }
    EXPECT_NEAR(*geodesicDistance(*line, *point, system), nearest_m, 0.05);
    EXPECT_NEAR(*geodesicDistance(*point, *line, system), nearest_m, 0.05);
    EXPECT_NEAR(*geodesicDistance(*line, *area, system), nearest_m, 0.05) << "the area's nearest corner is the point";
  }
  EXPECT_EQ(metres(kCrs84 + "POINT(8.5 50.5)", kCrs84 + "POLYGON((8 50, 9 50, 9 51, 8 51, 8 50))"), 0);
  EXPECT_EQ(metres(kCrs84 + "POINT EMPTY", kCrs84 + "POINT(8 50)"), -1);
}

TEST(Geodesy, LeavesUnboundWithANoteWhatItCannotMeasure) {
  const std::string nowhere = "<http://www.opengis.net/def/crs/EPSG/0/99> ",
                    geocentric = "<http://www.opengis.net/def/crs/EPSG/0/4978> ";
  for (const auto& [a, b, note] : std::vector<std::array<std::string, 3>>{
           {kCrs84 + "POINT(1 2)", "POINT(1 2)", "the map frame"},
           {kCrs84 + "POINT(1 2)", kEpsg4326 + "POINT(2 1)", "different coordinate systems"},
           {nowhere + "POINT(1 2)", nowhere + "POINT(1 3)", "that PROJ knows"},
           {geocentric + "POINT(1 2)", geocentric + "POINT(1 3)", "that PROJ knows"},
           {kEpsg4326 + "POINT(100 50)", kEpsg4326 + "POINT(50 100)", "names the latitude first"}}) {
    EXPECT_EQ(metres(a, b), -1) << a << b;
    const auto notes = notesOn(distanceCall(a, b));
    ASSERT_EQ(notes.size(), 1U) << a << b;
    EXPECT_THAT(notes[0], HasSubstr(note));
  }
  EXPECT_EQ(
      notesOn("geof:sfIntersects(\"" + kCrs84 + "POINT(1 2)\"^^geo:wktLiteral, \"POINT(1 2)\"^^geo:wktLiteral)").size(),
      1U);
}

TEST(Geodesy, TellsThatHeightsAreLeftOut) {
  for (const char* high : {"POINT Z(0 0 9)", "POINT(0 0 9)", "LINESTRING ZM(0 0 1 2, 1 0 1 2)"})
    EXPECT_THAT(notesOn(distanceCall(high, "POINT(1 0)")), testing::ElementsAre(HasSubstr("Z and M"))) << high;
  EXPECT_TRUE(notesOn(distanceCall("POINT(0 0)", "POINT(1 0)")).empty());
}

TEST(Geodesy, FiltersKeepTheRowsThatTheDistanceFinds) {
  SmallStore store;
  std::vector<Quad> quads;
  std::mt19937 random(11);
  for (int i = 0; i < 400; ++i) {
    const std::string x = std::to_string(10 + static_cast<double>(random() % 10'000) * 1e-6);
    const std::string y = std::to_string(70 + static_cast<double>(random() % 10'000) * 1e-6);
    for (const auto& [name, place] :
         {std::pair<std::string, std::string>{"degrees", kCrs84 + "POINT(" + x + " " + y + ")"},
          {"feet", kFeet + "POINT(" + x + " " + std::to_string(i) + ")"}})
      quads.push_back({Term::iri("http://example.org/" + name + std::to_string(i)),
                       Term::iri(std::string(vocabulary::kGeo) + "asWKT"),
                       Term::literal(place, std::string(vocabulary::kGeo) + "wktLiteral"), Term::iri("")});
  }
  store.load(quads);
  for (const auto& [centre, limit] :
       {std::pair<std::string, std::string>{kCrs84 + "POINT(10.005 70.005)", "100"}, {kFeet + "POINT(10 200)", "10"}}) {
    const std::string distance = "geof:distance(?g, \"" + centre + "\"^^geo:wktLiteral)";
    const auto filtered = store.rows("SELECT ?o { ?o geo:asWKT ?g FILTER(" + distance + " < " + limit + ") }");
    const auto all = store.rows("SELECT ?o { { SELECT ?o (" + distance + " AS ?d) { ?o geo:asWKT ?g } } FILTER(?d < " +
                                limit + ") }");
    EXPECT_GT(filtered.size(), 5U);
    EXPECT_LT(filtered.size(), 200U);
    EXPECT_EQ(filtered, all);
  }
}

}  // namespace
}  // namespace cluxel::test
