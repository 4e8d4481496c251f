// SPDX-License-Identifier: Apache-2.0
// Outlines that are put together from tiles, and the GeoJSON that is written feature by feature, against those of the
// whole scene.
#include "tasks/export/object_outlines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/convex_hull.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Corners = std::vector<Eigen::Vector2d>;

/// The hull of the boxes of all cluxels of an object, each wider by 5 mm.
Corners footprintInScene(const mapping::MapReader& map, const rules::SemanticObject& object) {
  const perception::SceneCluxels& cluxels = map.scene().cluxels;
  Corners corners;
  for (const std::uint32_t c : mapping::cluxelsOf(object)) {
    const Eigen::Vector2d corner = cluxels.low_corner[c].head<2>(), extent = cluxels.extent[c].head<2>().cast<double>();
    const Eigen::Vector2d low = corner.array() - 0.005, high = (corner + extent).array() + 0.005;
    corners.insert(corners.end(), {low, {high.x(), low.y()}, {low.x(), high.y()}, high});
  }
  return convexHull(std::move(corners));
}

TEST(ObjectOutlines, AreThoseOfTheWholeSceneToTheLastBitWhateverFitsIntoMemory) {
  const mapping::MapReader& map = CampusMap::shared().map();
  const auto& objects = map.objects();
  for (const std::size_t bytes : {std::size_t{1}, SortedRecords::kUsualBytes}) {
    std::uint32_t next = 0;
    forEachOutline(
        map,
        [&](std::uint32_t number, const ObjectOutline& outline) {
          ASSERT_EQ(number, next++);
          EXPECT_EQ(convexHull(outline.footprint), footprintInScene(map, objects[number]));
          const auto expected = mapping::geometryOf(map.scene().cluxels, mapping::cluxelsOf(objects[number]));
          const auto got = mapping::geometryOf(outline.extent);
          EXPECT_EQ(got.box.size, expected.box.size);
          EXPECT_EQ(got.box.yaw_rad, expected.box.yaw_rad);
          EXPECT_EQ(got.min, expected.min);
          EXPECT_EQ(got.max, expected.max);
        },
        bytes);
    EXPECT_EQ(next, objects.size());
  }
}

OrderedJson featureOf(const mapping::MapReader& map, std::size_t number, const rdf::OntologyView& ontology) {
  const auto rounded = [](double value) { return std::round(value * 1000) / 1000; };
  const rules::SemanticObject& object = map.objects()[number];
  OrderedJson ring = OrderedJson::array();
  for (const Eigen::Vector2d& p : footprintInScene(map, object)) ring.push_back({rounded(p.x()), rounded(p.y())});
  ring.push_back(ring.front());
  const auto box = mapping::geometryOf(map.scene().cluxels, mapping::cluxelsOf(object)).box;
  return {{"type", "Feature"},
          {"id", object.id.hex()},
          {"geometry", {{"type", "Polygon"}, {"coordinates", OrderedJson::array({ring})}}},
          {"properties",
           {{"label", ontology.find(object.class_iri)->label()},
            {"class", mapping::localName(object.class_iri)},
            {"height", rounded(box.size.z())},
            {"width", rounded(box.size.y())},
            {"confidence", rounded(object.confidence)},
            {"iri", rdf::iriOfObject(object.id)},
            {"rule", object.rule_id},
            {"number", number}}}};
}

TEST(ObjectOutlines, GiveTheBytesOfACollectionThatIsWrittenAsAWhole) {
  const mapping::MapReader& map = CampusMap::shared().map();
  const rdf::OntologyView ontology = rdf::ontologyViewOf(map.quads());
  const mapping::MapInputs inputs = map.inputs();
  OrderedJson whole{{"type", "FeatureCollection"}};
  whole["frame"] = "map frame of Cluxel, metres: not longitude and latitude";
  whole["crs_of_origin"] = inputs.crs;
  whole["origin"] = {inputs.map_origin.x(), inputs.map_origin.y(), inputs.map_origin.z()};
  whole["features"] = OrderedJson::array();
  for (std::size_t i = 0; i < map.objects().size(); ++i) whole["features"].push_back(featureOf(map, i, ontology));
  std::string text;
  exportMap(
      map, ExportFormat::GeoJson, [&](std::string_view piece) { text.append(piece); }, ExportFrame::Local);
  EXPECT_EQ(text, whole.dump(1) + "\n");
}

}  // namespace
}  // namespace cluxel::tasks
