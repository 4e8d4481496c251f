// SPDX-License-Identifier: Apache-2.0
// The shipped rules of places: parking rows, facade fronts, kinds of ways and crossings, areas, and that they follow
// changes of a map.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "mapping/change/map_change.hpp"
#include "mapping/facts/fact_sink.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

const std::string kPlacePrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX geo: <http://www.opengis.net/ont/geosparql#> ";

std::size_t rowsIn(const QuadReader& reader, const std::string& pattern) {
  return sparql::evaluateQuery(reader, kPlacePrefixes + "SELECT * WHERE { " + pattern + " }").table.row_count;
}

/// A store of things with the facts that a build writes of them.
class PlaceRules : public testing::Test {
 protected:
  void add(const Term& subject, const std::string& property, const Term& object) {
    QuadWriter writer(transaction);
    writer.add(Quad{subject, Term::iri(property), object, Term::iri(vocabulary::kGraphObserved)});
    writer.flush();
  }
  void addNumber(const Term& subject, const std::string& property, double value) {
    add(subject, vocabulary::clx(property), Term::literal(decimalText(value, 3), vocabulary::xsd("decimal")));
  }
  void addBox(const Term& subject, double min_x, double min_y, double max_x, double max_y) {
    addNumber(subject, "minX", min_x), addNumber(subject, "minY", min_y);
    addNumber(subject, "maxX", max_x), addNumber(subject, "maxY", max_y);
  }
  static Term thing(const std::string& name) { return Term::iri("https://example.org/" + name); }
  void addType(const Term& subject, const std::string& name) {
    add(subject, vocabulary::rdf("type"), Term::iri(vocabulary::clx(name)));
  }
  void addVehicle(const std::string& name, double x, double y, double heading_rad, double length_m = 4) {
    const Term vehicle = thing(name), centroid = thing(name + "/centroid");
    const std::string geo(vocabulary::kGeo);
    addType(vehicle, "Vehicle");
    addNumber(vehicle, "heading", heading_rad);
    addNumber(vehicle, "x", x), addNumber(vehicle, "y", y);
    addNumber(vehicle, "length", length_m), addNumber(vehicle, "width", 0.4 * length_m);
    addBox(vehicle, x - 1, y - 1, x + 1, y + 1);
    add(vehicle, geo + "hasCentroid", centroid);
    add(centroid, geo + "asWKT",
        Term::literal("POINT (" + decimalText(x, 3) + " " + decimalText(y, 3) + ")", geo + "wktLiteral"));
  }
  void addWall(const std::string& name, double length_m, bool on_ground) {
    const Term building = thing("house"), facade = thing("facade"), wall = thing(name);
    addType(building, "Building");
    addType(facade, "Facade");
    addType(wall, "VerticalPlane");
    add(building, vocabulary::clx("hasPart"), facade);
    add(facade, vocabulary::clx("hasPrimitive"), wall);
    addNumber(wall, "length", length_m);
    addBox(wall, 0, 0, length_m, 0.5);
    if (on_ground) add(wall, vocabulary::clx("touchesGround"), thing("ground"));
  }
  void addWay(const std::string& name, double width_m, double lower, double higher, double length_m = 10) {
    const Term way = thing(name);
    addType(way, "Way");
    addNumber(way, "width", width_m), addNumber(way, "length", length_m);
    addNumber(way, "lowerBeside", lower), addNumber(way, "higherBeside", higher);
  }
  void addBarrier(const std::string& name, double porosity, int rays, double width_m) {
    const Term barrier = thing(name);
    addType(barrier, "Barrier");
    addNumber(barrier, "porosity", porosity), addNumber(barrier, "width", width_m);
    add(barrier, vocabulary::clx("rayCount"), Term::literal(std::to_string(rays), vocabulary::xsd("integer")));
  }
  /// The superclass as the closure of the ontology would give it.
  void derive() {
    add(Term::iri(vocabulary::clx("ParkingRow")), vocabulary::rdfs("subClassOf"), Term::iri(vocabulary::clx("Place")));
    add(Term::iri(vocabulary::clx("FacadeFront")), vocabulary::rdfs("subClassOf"), Term::iri(vocabulary::clx("Place")));
    runSparqlRules(transaction, shippedInputs().sparql_rules);
  }
  std::size_t countOf(const std::string& pattern) {
    return rowsIn(QuadReader{static_cast<const ReadTransaction&>(transaction)}, pattern);
  }

  std::shared_ptr<Environment> environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
};

TEST_F(PlaceRules, VehiclesInALineAreARowWhicheverWayTheyFace) {
  constexpr double kHeading = 2.0;  // also beyond a quarter of a circle
  const auto addInLine = [&](const std::string& name, double along, double across, double heading_rad) {
    addVehicle(name, along * std::cos(kHeading) - across * std::sin(kHeading),
               along * std::sin(kHeading) + across * std::cos(kHeading), heading_rad);
  };
  addInLine("a", 0, 0, kHeading);
  addInLine("b", 6, 0.5, kHeading - std::numbers::pi);
  addInLine("c", 12, 0, kHeading - 0.1);
  addInLine("d", 20.9, 0, kHeading + 0.1 - std::numbers::pi);  // 8.9 m from c, turned by 0.2
  addInLine("opposite", 6, 5.6, kHeading);
  derive();
  EXPECT_EQ(countOf("?row a clx:ParkingRow"), 1U);
  EXPECT_EQ(countOf("?row a clx:ParkingRow ; clx:hasMember ?vehicle"), 4U);
  EXPECT_EQ(countOf("?row clx:hasMember <https://example.org/opposite>"), 0U);
}

TEST_F(PlaceRules, VehiclesSideBySideAreARow) {
  for (int i = 0; i < 3; ++i) addVehicle("bay" + std::to_string(i), 2.7 * i, 0.2 * i, 1.55);
  derive();
  EXPECT_EQ(countOf("?row a clx:ParkingRow ; clx:hasMember ?vehicle"), 3U);
}

TEST_F(PlaceRules, AWayIsARoadASidewalkOrAPath) {
  addWay("wide", 4.5, 0, 0);
  addWay("belowKerb", 3, 0, 0.6);
  addWay("aboveKerb", 4.4, 0.6, 0);
  addWay("garden", 2.9, 0.4, 0.6);
  derive();
  const std::map<std::string, std::string> kinds{
      {"wide", "Road"}, {"belowKerb", "Road"}, {"aboveKerb", "Sidewalk"}, {"garden", "Path"}};
  for (const auto& [name, kind] : kinds)
    for (const char* other : {"Road", "Sidewalk", "Path"})
      EXPECT_EQ(countOf("<https://example.org/" + name + "> a clx:" + other), other == kind ? 1U : 0U) << name << other;
}

TEST_F(PlaceRules, ABarrierThatRaysGoThroughIsAFenceAndASolidThickOneAWall) {
  addBarrier("pickets", 0.3, 200, 0.2);
  addBarrier("masonry", 0.01, 400, 0.3);
  addBarrier("hedge", 0.3, 200, 1.2);
  addBarrier("boards of one side", 0, 400, 0.1);
  addBarrier("seen by few rays", 0.3, 19, 0.2);
  addBarrier("part of both", 0.06, 400, 0.3);
  derive();
  EXPECT_EQ(countOf("?b a clx:Fence"), 1);
  EXPECT_EQ(countOf("<https://example.org/pickets> a clx:Fence"), 1);
  EXPECT_EQ(countOf("?b a clx:Wall"), 1);
  EXPECT_EQ(countOf("<https://example.org/masonry> a clx:Wall"), 1);
}

TEST_F(PlaceRules, ThreeWaysThatAreNoBaysMakeACrossing) {
  for (const char* junction : {"crossing", "entrance"})
    for (int i = 0; i < 3; ++i) {
      const std::string way = junction + std::to_string(i);
      addWay(way, 2, 0, 0, std::string(junction) == "entrance" && i == 0 ? 2.9 : 3.0);
      add(thing(way), vocabulary::clx("connects"), thing(junction));
    }
  derive();
  EXPECT_EQ(countOf("?place a clx:Crossing"), 1U);
  EXPECT_EQ(countOf("<https://example.org/crossing> a clx:Crossing"), 1U);
}

TEST_F(PlaceRules, TwoVehiclesAndTurnedDistantOrSmallOnesAreNoRow) {
  addVehicle("a", 0, 0, 0);
  addVehicle("b", 6, 0, 0);
  addVehicle("turned", 12, 0, 0.4);
  addVehicle("distant", -9.1, 0, 0);
  addVehicle("cycle", 3, 0, 0, 1.8);
  derive();
  EXPECT_EQ(countOf("?a clx:parkedBeside ?b"), 2U);
  EXPECT_EQ(countOf("?row a clx:ParkingRow"), 0U);
}

TEST_F(PlaceRules, APlaceReachesAroundItsMembers) {
  addVehicle("a", -6, 0, 0);
  addVehicle("b", 0, 1, 0);
  addVehicle("c", 6, 0, 0);
  derive();
  EXPECT_EQ(countOf("?row a clx:ParkingRow ; geo:hasBoundingBox ?box . ?box a geo:Geometry ; geo:asWKT "
                    "\"POLYGON ((-7.0 -1.0, 7.0 -1.0, 7.0 2.0, -7.0 2.0, -7.0 -1.0))\"^^geo:wktLiteral"),
            1U);
}

TEST_F(PlaceRules, AFrontIsALongWallThatStandsOnGround) {
  addWall("front", 6, true);
  addWall("upper", 6, false);
  addWall("short", 1.9, true);
  derive();
  EXPECT_EQ(countOf("?front a clx:FacadeFront"), 1U);
  EXPECT_EQ(countOf("?front a clx:FacadeFront ; clx:hasMember <https://example.org/house> ; "
                    "clx:hasWall <https://example.org/front> ; geo:hasBoundingBox/geo:asWKT ?area"),
            1U);
}

TEST(PlacesOfAMap, FollowScansThatComeAndGo) {
  const SmallCampus campus({.seed = 5, .stops = 3, .size_m = 45, .points_per_stop = 12'000});
  const MapInputs inputs = shippedInputs();
  const auto& files = campus.files();
  const std::string whole = builtText(files, inputs), less = builtText({files[0], files[1]}, inputs);
  const std::filesystem::path file = files[0].parent_path() / "map.clx";
  buildMap(scansOf({files[1]}), inputs, file, {}, silence());
  extendMap(file, scansOf({files[2]}), {}, silence());
  extendMap(file, scansOf({files[0]}), {}, silence());
  EXPECT_TRUE(canonicalText(file) == whole);
  {
    const MapReader map(file);
    // Cars of so few scans make no row; the tests above have rows.
    EXPECT_GE(rowsIn(map.quads(), "?front a clx:FacadeFront ; geo:hasBoundingBox ?box"), 2U);
  }
  ScanSet scans = scansOf(files);
  retractScans(file, {scans.load(2).id}, {}, silence());
  EXPECT_TRUE(canonicalText(file) == less);
  EXPECT_FALSE(less == whole);
}

}  // namespace
}  // namespace cluxel::mapping
