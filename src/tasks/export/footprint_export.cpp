// SPDX-License-Identifier: Apache-2.0
// One GeoJSON feature (RFC 7946) per object: the convex hull of its cluxels seen from above. Features are written one
// by one.
#include "tasks/export/footprint_export.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/convex_hull.hpp"
#include "cluxel/error.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "tasks/export/object_outlines.hpp"
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

Json polygonJson(const std::vector<Eigen::Vector2d>& hull, const PlaceWriter& position) {
  Json ring = Json::array();
  for (const Eigen::Vector2d& p : hull) {
    const Eigen::Vector2d written = position(p);
    ring.push_back({written.x(), written.y()});
  }
  if (!hull.empty()) ring.push_back(ring.front());
  return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json propertiesOf(std::uint32_t number, const mapping::ObjectRecord& object, const ObjectOutline& outline,
                  const mapping::MapReader& map, const rdf::OntologyView& ontology) {
  const rdf::OntologyClass* known = ontology.find(object.class_iri);
  const std::string class_name = map.classNames().nameOf(object.class_iri);
  const perception::UprightBox box = mapping::geometryOf(outline.extent).box;
  const std::string iri = rdf::iriOfObject(map.objectIds()[number]);
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

/// The lines of a value that stands `depth` levels deep.
std::string linesOf(const Json& json, std::size_t depth) {
  const std::string indent(depth, ' ');
  std::string lines = indent;
  for (const char c : json.dump(1)) {
    lines += c;
    if (c == '\n') lines += indent;
  }
  return lines;
}

/// Writes a collection without features, and then one feature after the other into it.
class FeatureWriter {
 public:
  FeatureWriter(Json collection, const ByteSink& out) : out_(out) {
    collection["features"] = Json::array();
    const std::string empty = collection.dump(1);
    const std::size_t inside = empty.rfind(']');
    out_(empty.substr(0, inside));
    end_ = empty.substr(inside) + "\n";
  }
  void add(const Json& feature) {
    out_((has_features_ ? ",\n" : "\n") + linesOf(feature, 2));
    has_features_ = true;
  }
  void finish() { out_((has_features_ ? "\n " : "") + end_); }

 private:
  const ByteSink& out_;
  std::string end_;
  bool has_features_ = false;
};

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
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  Json collection{{"type", "FeatureCollection"}};
  if (frame == ExportFrame::Local) {
    collection["frame"] = "map frame of Cluxel, metres: not longitude and latitude";
    collection["crs_of_origin"] = inputs.crs;
    collection["origin"] = {inputs.map_origin.x(), inputs.map_origin.y(), inputs.map_origin.z()};
  }
  FeatureWriter features(std::move(collection), out);
  forEachOutline(map, [&](std::uint32_t number, const ObjectOutline& outline) {
    const ContentHash& id = map.objectIds()[number];
    const auto object = mapping::storedRecord(map.transaction(), id);
    if (!object) mapping::refuseDamaged("an object has no record");
    features.add(Json{{"type", "Feature"},
                      {"id", id.hex()},
                      {"geometry", polygonJson(convexHull(outline.footprint), position)},
                      {"properties", propertiesOf(number, *object, outline, map, ontology)}});
  });
  features.finish();
}

}  // namespace cluxel::tasks
