// SPDX-License-Identifier: Apache-2.0
// GeoJSON of a map: in metres of the map frame, and in longitude and latitude of a georeferenced copy of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/export/map_export.hpp"
#include "tasks/export/proj_geo_reference.hpp"
#include "test_paths.hpp"

namespace cluxel::tasks {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

Json footprints(const mapping::MapReader& map, ExportFrame frame) {
  std::string text;
  exportMap(
      map, ExportFormat::GeoJson, [&](std::string_view piece) { text.append(piece); }, frame);
  return Json::parse(text);
}

/// Relative to the first corner: products of whole degrees would round away rings of some centimetres.
double areaOf(const Json& ring) {
  const double x0 = ring[0][0], y0 = ring[0][1];
  double twice = 0;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i)
    twice += (ring[i][0].get<double>() - x0) * (ring[i + 1][1].get<double>() - y0) -
             (ring[i + 1][0].get<double>() - x0) * (ring[i][1].get<double>() - y0);
  return twice / 2;
}

TEST(Footprints, AreOnePolygonPerObjectInItsPlace) {
  constexpr double kTolerance_m = 0.25;
  const auto& objects = CampusMap::shared().map().objects();
  const auto boxes = CampusMap::shared().boxesInRdf();
  const Json collection = footprints(CampusMap::shared().map(), ExportFrame::Local);
  EXPECT_EQ(collection.at("type"), "FeatureCollection");
  EXPECT_THAT(collection.at("frame").get<std::string>(), HasSubstr("metres"));
  const Json& features = collection.at("features");
  ASSERT_EQ(features.size(), objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    EXPECT_EQ(features[i].at("type"), "Feature");
    EXPECT_EQ(features[i].at("id"), objects[i].id.hex());
    EXPECT_EQ(features[i].at("geometry").at("type"), "Polygon");
    ASSERT_EQ(features[i].at("geometry").at("coordinates").size(), 1U);
    const Json& ring = features[i].at("geometry").at("coordinates")[0];
    ASSERT_GE(ring.size(), 4U) << "RFC 7946: a ring has four positions or more";
    EXPECT_EQ(ring.front(), ring.back()) << "RFC 7946: a ring is closed";
    EXPECT_GT(areaOf(ring), 0) << "RFC 7946: an outer ring runs counter-clockwise";
    Eigen::AlignedBox2d footprint;
    for (const Json& p : ring) footprint.extend(Eigen::Vector2d(p[0].get<double>(), p[1].get<double>()));
    const Eigen::AlignedBox3d& said = boxes.at(objects[i].id.hex());
    EXPECT_LT((footprint.min() - said.min().head<2>()).cwiseAbs().maxCoeff(), kTolerance_m);
    EXPECT_LT((footprint.max() - said.max().head<2>()).cwiseAbs().maxCoeff(), kTolerance_m);
  }
}

TEST(Footprints, HoldWhatIsKnownOfTheObject) {
  const mapping::MapReader& map = CampusMap::shared().map();
  const auto rows = sparql::evaluateQuery(
      map.quads(),
      "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?o ?h ?w { ?o clx:confidence ?c ; clx:height ?h ; "
      "clx:width ?w }");
  std::map<std::string, std::pair<double, double>> height_and_width_m;
  for (std::size_t i = 0; i < rows.table.row_count; ++i)
    height_and_width_m[textAt(rows.table, i, "o")] = {numberAt(rows.table, i, "h"), numberAt(rows.table, i, "w")};
  const Json features = footprints(map, ExportFrame::Local).at("features");
  for (std::size_t i = 0; i < map.objects().size(); ++i) {
    const rules::SemanticObject& object = map.objects()[i];
    const Json& properties = features[i].at("properties");
    EXPECT_EQ(properties.at("class"), mapping::localName(object.class_iri));
    EXPECT_FALSE(properties.at("label").get<std::string>().empty());
    EXPECT_EQ(properties.at("iri"), rdf::iriOfObject(object.id));
    EXPECT_EQ(properties.at("rule"), object.rule_id);
    EXPECT_EQ(properties.at("number"), i);
    EXPECT_NEAR(properties.at("confidence").get<double>(), object.confidence, 0.001);
    const auto [height_m, width_m] = height_and_width_m.at(rdf::iriOfObject(object.id));
    EXPECT_NEAR(properties.at("height").get<double>(), height_m, 0.001);
    EXPECT_NEAR(properties.at("width").get<double>(), width_m, 0.001);
  }
}

TEST(Footprints, RefuseDegreesForAMapWithoutCoordinateSystem) {
  try {
    footprints(CampusMap::shared().map(), ExportFrame::LongitudeLatitude);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.remedy(), Remedy::LocalFrame);
    EXPECT_THAT(error.what(), HasSubstr("no coordinate system"));
  }
}

TEST(Footprints, OfAGeoreferencedMapAreInLongitudeAndLatitude) {
  const ScratchFolder folder;
  mapping::MapInputFiles files;
  files.model = "campus";
  std::string manifest = "map_origin: [456000, 5412000, 0]\ncrs: EPSG:25832\nscans:\n";
  for (const auto& scan : CampusMap::shared().campus().files()) manifest += "  - " + scan.string() + "\n";
  writeFile(folder.path() / "campus.yaml", manifest);
  buildMap(scansOf({folder.path() / "campus.yaml"}), readMapInputs(files, DataHome(test::sourceFolder())),
           folder.path() / "map.clx", {.threads = 2}, silence());
  const mapping::MapReader map(folder.path() / "map.clx");
  const Json degrees = footprints(map, ExportFrame::LongitudeLatitude), metres = footprints(map, ExportFrame::Local);
  EXPECT_FALSE(degrees.contains("frame"));
  ASSERT_EQ(degrees.at("features").size(), metres.at("features").size());
  ASSERT_GT(metres.at("features").size(), 0U);
  // A sphere is near enough for distances of some tens of metres from one corner to another.
  constexpr double kMetresPerDegree = 111'200, kLatitude_deg = 48.86, kTolerance = 0.01;
  const double squeeze = std::cos(kLatitude_deg * std::numbers::pi / 180);
  for (std::size_t i = 0; i < metres.at("features").size(); ++i) {
    const Json& ring = degrees.at("features")[i].at("geometry").at("coordinates")[0];
    const double lon = ring[0][0], lat = ring[0][1];
    EXPECT_NEAR(lon, 8.4, 0.1);
    EXPECT_NEAR(lat, kLatitude_deg, 0.1);
    EXPECT_GT(areaOf(ring), 0) << "RFC 7946: an outer ring runs counter-clockwise";
    const double area_m2 = areaOf(ring) * kMetresPerDegree * kMetresPerDegree * squeeze;
    const double expected_m2 = areaOf(metres.at("features")[i].at("geometry").at("coordinates")[0]);
    EXPECT_NEAR(area_m2, expected_m2, kTolerance * expected_m2 + 0.001);
  }
}

TEST(GeoReference, PlacesKnownPoints) {
  // 3 deg west of UTM's central meridians the false easting is 500 km: zone 32 has 9 degrees east.
  const GeoReference utm("EPSG:25832", {500000, 0, 0});
  EXPECT_NEAR(utm.longitudeLatitude({0, 0}).x(), 9, 1e-9);
  EXPECT_NEAR(utm.longitudeLatitude({0, 0}).y(), 0, 1e-9);
  // Length of the meridian from the equator to 45 degrees on GRS 80 (4984944.378 m) times UTM's scale 0.9996.
  EXPECT_NEAR(utm.longitudeLatitude({0, 4984944.378 * 0.9996}).y(), 45, 1e-7);
}

TEST(GeoReference, TakesEastBeforeNorthWhateverTheSystemsOwnOrder) {
  const GeoReference gauss_krueger("EPSG:31467", {3500000, 5400000, 0});  // its first axis points north
  const Eigen::Vector2d degrees = gauss_krueger.longitudeLatitude({0, 0});
  EXPECT_NEAR(degrees.x(), 9, 0.01);
  EXPECT_NEAR(degrees.y(), 48.7, 0.1);
}

TEST(GeoReference, RefusesWhatIsNoProjectedSystemInMetres) {
  for (const char* crs : {"EPSG:4326", "EPSG:2263", "EPSG:0", "nonsense", "EPSG:4978"}) {
    try {
      GeoReference(crs, Eigen::Vector3d::Zero());
      FAIL() << crs << " was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.remedy(), Remedy::LocalFrame) << crs;
      EXPECT_THAT(error.what(), HasSubstr(crs));
    }
  }
}

}  // namespace
}  // namespace cluxel::tasks
