// SPDX-License-Identifier: Apache-2.0
// One GeoJSON feature (RFC 7946) per object: the convex hull of its cluxels seen from above.
#include "tasks/export/footprint_export.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/convex_hull.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "tasks/export/proj_geo_reference.hpp"
#include "tasks/gone_things.hpp"

namespace cluxel::tasks {

namespace {

using Json = nlohmann::ordered_json;

double rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

constexpr double kPerMetre = 1e3;   // millimetres
constexpr double kPerDegree = 1e9;  // 0.1 mm on the ground

/// Gives an object of one point an area [m].
constexpr double kMargin_m = 0.005;

std::vector<Eigen::Vector2d> footprintOf(const rules::SemanticObject& object, const perception::SceneCluxels& cluxels) {
  std::vector<Eigen::Vector2d> corners;
  for (const rules::ObjectPart& part : object.parts)
    for (const std::uint32_t c : part.cluxels) {
      const Eigen::Vector2d corner = cluxels.low_corner[c].head<2>(),
                            extent = cluxels.extent[c].head<2>().cast<double>();
      const Eigen::Vector2d low = corner.array() - kMargin_m, high = (corner + extent).array() + kMargin_m;
      corners.insert(corners.end(), {low, {high.x(), low.y()}, {low.x(), high.y()}, high});
    }
  return convexHull(std::move(corners));
}

Json polygonJson(const std::vector<Eigen::Vector2d>& hull, const PlaceWriter& position) {
  Json ring = Json::array();
  for (const Eigen::Vector2d& p : hull) {
    const Eigen::Vector2d written = position(p);
    ring.push_back({written.x(), written.y()});
  }
  if (!hull.empty()) ring.push_back(ring.front());
  return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json propertiesOf(const rules::SemanticObject& object, std::size_t number, const mapping::MapReader& map,
                  const rdf::OntologyView& ontology) {
  const rdf::OntologyClass* known = ontology.find(object.class_iri);
  const std::string class_name = map.classNames().nameOf(object.class_iri);
  const perception::UprightBox box = mapping::geometryOf(map.scene().cluxels, mapping::cluxelsOf(object)).box;
  const std::string iri = rdf::iriOfObject(object.id);
  Json json{{"label", known == nullptr ? class_name : known->label()},
            {"class", class_name},
            {"height", rounded(box.size.z(), kPerMetre)},
            {"width", rounded(box.size.y(), kPerMetre)},
            {"confidence", rounded(object.confidence, kPerMetre)},
            {"iri", iri},
            {"rule", object.rule_id},
            {"number", number}};
  if (const auto gone = seenThrough(map.quads(), iri)) json["seenThrough"] = *gone;
  return json;
}

}  // namespace

/// The georeference lives as long as the function.
PlaceWriter placesIn(ExportFrame frame, const mapping::MapInputs& inputs) {
  if (frame == ExportFrame::Local)
    return
        [](const Eigen::Vector2d& p) { return Eigen::Vector2d(rounded(p.x(), kPerMetre), rounded(p.y(), kPerMetre)); };
  if (inputs.crs.empty())
    throw Error(ErrorKind::InvalidArgument,
                "GeoJSON needs longitude and latitude, but the map has no coordinate system: its scans' manifest names "
                "no crs",
                Remedy::LocalFrame);
  const auto earth = std::make_shared<GeoReference>(inputs.crs, inputs.map_origin);
  return [earth](const Eigen::Vector2d& p) {
    const Eigen::Vector2d degrees = earth->longitudeLatitude(p);
    return Eigen::Vector2d(rounded(degrees.x(), kPerDegree), rounded(degrees.y(), kPerDegree));
  };
}

void writeFootprints(const mapping::MapReader& map, ExportFrame frame, const ByteSink& out) {
  const mapping::MapInputs inputs = map.inputs();
  const PlaceWriter position = placesIn(frame, inputs);
  const perception::SceneCluxels& cluxels = map.scene().cluxels;
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  Json features = Json::array();
  for (std::size_t i = 0; i < map.objects().size(); ++i) {
    const rules::SemanticObject& object = map.objects()[i];
    features.push_back({{"type", "Feature"},
                        {"id", object.id.hex()},
                        {"geometry", polygonJson(footprintOf(object, cluxels), position)},
                        {"properties", propertiesOf(object, i, map, ontology)}});
  }
  Json collection{{"type", "FeatureCollection"}};
  if (frame == ExportFrame::Local) {
    collection["frame"] = "map frame of Cluxel, metres: not longitude and latitude";
    collection["crs_of_origin"] = inputs.crs;
    collection["origin"] = {inputs.map_origin.x(), inputs.map_origin.y(), inputs.map_origin.z()};
  }
  collection["features"] = std::move(features);
  out(collection.dump(1) + "\n");
}

}  // namespace cluxel::tasks
