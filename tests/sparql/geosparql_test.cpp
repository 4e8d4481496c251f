// SPDX-License-Identifier: Apache-2.0
// Tests of GeoSPARQL functions on plane geometry in metres.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sparql/geometry/geometry.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

std::string wkt(const std::string& text) {
  return "\"" + text + "\"^^geo:wktLiteral";
}
std::string call(const std::string& function, const std::string& a, const std::string& b) {
  return "geof:" + function + "(" + wkt(a) + ", " + wkt(b) + ")";
}
const std::string kGeoTrue = "\"true\"^^boolean", kGeoFalse = "\"false\"^^boolean";
const std::string kSquare = "POLYGON((0 0, 4 0, 4 4, 0 4, 0 0))";

TEST(GeoFunctions, MeasureInMetres) {
  const SmallStore store;
  EXPECT_EQ(store.value(call("distance", "POINT(0 0)", "POINT(3 4)")), "\"5.0E0\"^^double");
  EXPECT_EQ(store.value(call("distance", "POINT(2 2)", kSquare)), "\"0.0E0\"^^double");
  EXPECT_EQ(store.value(call("distance", "LINESTRING(0 10, 10 10)", kSquare)), "\"6.0E0\"^^double");
  EXPECT_EQ(store.value(call("distance", "POINT Z(0 0 9)", "MULTIPOINT((3 4), (1 0))")), "\"1.0E0\"^^double");
  EXPECT_EQ(store.value(call("distance", "POINT EMPTY", "POINT(1 0)")), "-");
}

TEST(GeoFunctions, RelateGeometries) {
  const SmallStore store;
  EXPECT_EQ(store.value(call("sfIntersects", kSquare, "LINESTRING(-1 2, 5 2)")), kGeoTrue);
  EXPECT_EQ(store.value(call("sfWithin", "POINT(1 1)", kSquare)), kGeoTrue);
  EXPECT_EQ(store.value(call("sfWithin", "POINT(0 1)", kSquare)), kGeoFalse) << "on the border is not within";
  EXPECT_EQ(store.value(call("sfContains", kSquare, "POLYGON((1 1, 2 1, 2 2, 1 1))")), kGeoTrue);
  EXPECT_EQ(store.value(call("sfTouches", kSquare, "POLYGON((4 0, 6 0, 6 4, 4 4, 4 0))")), kGeoTrue);
  EXPECT_EQ(store.value(call("sfTouches", kSquare, "POLYGON((3 0, 6 0, 6 4, 3 4, 3 0))")), kGeoFalse);
  EXPECT_EQ(store.value("geof:envelope(" + wkt("LINESTRING(1 5, 3 2)") + ")"),
            "\"POLYGON((1 2, 3 2, 3 5, 1 5, 1 2))\"^^<http://www.opengis.net/ont/geosparql#wktLiteral>");
}

TEST(GeoFunctions, GiveErrorsForWhatIsNoGeometry) {
  const SmallStore store;
  for (const char* text : {"", "POINT", "POINT(1)", "POINT(1 2", "POLYGON((0 0, 1 1, 0 0))", "POINT(nan 1)",
                           "CIRCLE(0 0 1)", "POINT(1 2) x"}) {
    EXPECT_EQ(store.value(call("distance", text, "POINT(0 0)")), "-") << text;
  }
  EXPECT_EQ(store.value("geof:distance(\"POINT(0 0)\", \"POINT(0 0)\")"), "-") << "a plain string";
}

TEST(GeoFunctions, TellEmptyGeometriesFromOthers) {
  const SmallStore store;
  EXPECT_EQ(store.value(call("sfWithin", "POINT EMPTY", kSquare)), kGeoFalse);
  EXPECT_EQ(store.value(call("sfContains", kSquare, "GEOMETRYCOLLECTION EMPTY")), kGeoFalse);
  EXPECT_EQ(store.value(call("sfDisjoint", kSquare, "POINT EMPTY")), kGeoTrue);
  EXPECT_EQ(store.value("geof:envelope(" + wkt("POLYGON EMPTY") + ")"), "-");
}

TEST(GeoFunctions, MeasureInNoOtherUnit) {
  const SmallStore store;
  const auto in = [&](const std::string& unit) {
    return store.value("geof:distance(" + wkt("POINT(0 0)") + ", " + wkt("POINT(3 4)") +
                       ", <http://www.opengis.net/def/uom/OGC/1.0/" + unit + ">)");
  };
  EXPECT_EQ(in("metre"), "\"5.0E0\"^^double");
  EXPECT_EQ(in("kilometre"), "-") << "5 km would be wrong by a thousand";
  EXPECT_EQ(in("degree"), "-");
}

/// Geometries in degrees and in metres cannot be compared.
TEST(GeoFunctions, DoNotRelateDifferentReferenceSystems) {
  const SmallStore store;
  const std::string degrees = "<http://www.opengis.net/def/crs/EPSG/0/4326> POINT(1 2)",
                    metres = "<http://www.opengis.net/def/crs/EPSG/0/25832> POINT(1 2)";
  EXPECT_EQ(store.value(call("distance", degrees, metres)), "-");
  EXPECT_EQ(store.value(call("sfIntersects", degrees, metres)), "-");
  EXPECT_EQ(store.value(call("distance", metres, metres)), "\"0.0E0\"^^double");
  EXPECT_EQ(store.value(call("distance", metres, "POINT(1 3)")), "-") << "without a name: the map's own frame";
}

TEST(GeoFunctions, PartsOnTheBorderAreWithinWhereOthersAreInside) {
  const SmallStore store;
  EXPECT_EQ(store.value(call("sfWithin", "MULTIPOINT((0 0), (1 1))", kSquare)), kGeoTrue);
  EXPECT_EQ(store.value(call("sfWithin", "MULTIPOINT((0 0), (4 1))", kSquare)), kGeoFalse) << "none is inside";
  EXPECT_EQ(store.value(call("sfWithin", "MULTIPOINT((1 1), (5 1))", kSquare)), kGeoFalse) << "one is outside";
}

/// Compares the R-tree's answers to distance and window queries with arithmetic, for points on a grid.
TEST(GeoFilters, FindTheSameObjectsAsComparisonsOfCoordinates) {
  SmallStore store;
  std::vector<Quad> quads;
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    const Term self = Term::iri("http://example.org/o" + std::to_string(i));
    const std::string x = std::to_string(random() % 1000), y = std::to_string(random() % 1000);
    quads.push_back({self, Term::iri("http://example.org/x"), Term::integer(std::stoi(x)), Term::iri("")});
    quads.push_back({self, Term::iri("http://example.org/y"), Term::integer(std::stoi(y)), Term::iri("")});
    quads.push_back({self, Term::iri("http://www.opengis.net/ont/geosparql#asWKT"),
                     Term::literal("POINT(" + x + " " + y + ")", "http://www.opengis.net/ont/geosparql#wktLiteral"),
                     Term::iri("")});
  }
  store.load(quads);
  const auto by_numbers =
      store.rows("SELECT ?o { ?o :x ?x ; :y ?y FILTER((?x - 500) * (?x - 500) + (?y - 400) * (?y - 400) < 10000) }");
  EXPECT_GT(by_numbers.size(), 20u);
  EXPECT_EQ(store.rows("SELECT ?o { ?o geo:asWKT ?g FILTER(geof:distance(?g, " + wkt("POINT(500 400)") + ") < 100) }"),
            by_numbers);
  EXPECT_EQ(store.rows("SELECT ?o { ?o geo:asWKT ?g FILTER(100 > geof:distance(" + wkt("POINT(500 400)") + ", ?g)) }"),
            by_numbers);
  const auto window = store.rows("SELECT ?o { ?o :x ?x ; :y ?y FILTER(?x > 100 && ?x < 300 && ?y > 200 && ?y < 250) }");
  EXPECT_EQ(store.rows("SELECT ?o { ?o geo:asWKT ?g FILTER(geof:sfWithin(?g, " +
                       wkt("POLYGON((100 200, 300 200, 300 250, 100 250, 100 200))") + ")) }"),
            window);
}

}  // namespace
}  // namespace cluxel::test
