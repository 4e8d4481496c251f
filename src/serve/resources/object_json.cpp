// SPDX-License-Identifier: Apache-2.0
// Values of the facade as JSON.
#include "serve/resources/object_json.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "mapping/map_reader.hpp"
#include "tasks/gone_things.hpp"

namespace cluxel::serve {

namespace {

double rounded(double value) {
  return std::round(value * 1000) / 1000;
}

ObjectJson vectorJson(const Position& p_map) {
  return {rounded(p_map.x), rounded(p_map.y), rounded(p_map.z)};
}

void addExtent(ObjectJson& json, const Extent& extent) {
  json["centroid"] = vectorJson(extent.centroid);
  json["min"] = vectorJson(extent.min);
  json["max"] = vectorJson(extent.max);
  json["length"] = extent.length_m;
  json["width"] = extent.width_m;
  json["height"] = extent.height_m;
  json["bottom"] = extent.bottom_m;
  json["top"] = extent.top_m;
  json["pointCount"] = extent.point_count;
}

}  // namespace

ObjectJson objectJson(const Object& object, const rdf::QuadReader& quads, const rdf::ClassNames& names) {
  ObjectJson json{{"id", mapping::localName(object.iri)},
                  {"iri", object.iri},
                  {"number", object.number},
                  {"class", names.nameOf(object.class_iri)},
                  {"classIri", object.class_iri},
                  {"label", object.label},
                  {"confidence", object.confidence},
                  {"rule", object.rule},
                  {"heading", object.heading_rad}};
  addExtent(json, object);
  if (const auto gone = tasks::seenThrough(quads, object.iri)) json["seenThrough"] = *gone;
  json["parts"] = ObjectJson::array();
  for (const ObjectPart& part : object.parts) {
    ObjectJson entry{{"iri", part.iri}, {"class", names.nameOf(part.class_iri)}, {"label", part.label}};
    addExtent(entry, part);
    json["parts"].push_back(std::move(entry));
  }
  return json;
}

ObjectJson pointsJson(const PointCloud& points) {
  ObjectJson json{{"count", points.size()},
                  {"x", ObjectJson::array()},
                  {"y", ObjectJson::array()},
                  {"z", ObjectJson::array()},
                  {"label", ObjectJson::array()}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    json["x"].push_back(rounded(points.x[i]));
    json["y"].push_back(rounded(points.y[i]));
    json["z"].push_back(rounded(points.z[i]));
    json["label"].push_back(nameOf(points.label[i]));
  }
  if (!points.intensity.empty()) json["intensity"] = points.intensity;
  return json;
}

std::string metres(double value_m) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", value_m);
  return text.data();
}

}  // namespace cluxel::serve
