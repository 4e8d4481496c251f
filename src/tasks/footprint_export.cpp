// SPDX-License-Identifier: Apache-2.0
// One GeoJSON feature an object: the convex hull of its cluxels seen from above.
#include "tasks/footprint_export.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cluxel/perception/footprint_hull.hpp"

namespace cluxel {

namespace {

using Json = nlohmann::ordered_json;

double rounded(double value_m) {
  return std::round(value_m * 1000) / 1000;
}

/// So that an object of one point has a polygon too [m].
constexpr double kMargin_m = 0.005;

std::vector<Eigen::Vector2d> footprintOf(const SemanticObject& object, const SceneCluxels& cluxels) {
  std::vector<Eigen::Vector2d> corners;
  for (const ObjectPart& part : object.parts)
    for (const std::uint32_t c : part.cluxels) {
      const Eigen::Vector2d corner = cluxels.low_corner[c].head<2>(),
                            extent = cluxels.extent[c].head<2>().cast<double>();
      const Eigen::Vector2d low = corner.array() - kMargin_m, high = (corner + extent).array() + kMargin_m;
      corners.insert(corners.end(), {low, {high.x(), low.y()}, {low.x(), high.y()}, high});
    }
  return convexHull(std::move(corners));
}

Json polygonJson(const std::vector<Eigen::Vector2d>& hull) {
  Json ring = Json::array();
  for (const Eigen::Vector2d& p : hull) ring.push_back({rounded(p.x()), rounded(p.y())});
  if (!hull.empty()) ring.push_back(ring.front());
  return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json featureJson(const SemanticObject& object, const SceneCluxels& cluxels) {
  return {
      {"type", "Feature"},
      {"id", object.id.hex()},
      {"geometry", polygonJson(footprintOf(object, cluxels))},
      {"properties",
       {{"class", localName(object.class_iri)}, {"confidence", rounded(object.confidence)}, {"rule", object.rule_id}}}};
}

}  // namespace

void writeFootprints(const MapReader& map, const ByteSink& out) {
  const SceneCluxels& cluxels = map.scene().cluxels;
  Json features = Json::array();
  for (const SemanticObject& object : map.objects()) features.push_back(featureJson(object, cluxels));
  const MapInputs inputs = map.inputs();
  const Json collection{{"type", "FeatureCollection"},
                        {"frame", "map frame of Cluxel, metres"},
                        {"crs_of_origin", inputs.crs},
                        {"origin", {inputs.map_origin.x(), inputs.map_origin.y(), inputs.map_origin.z()}},
                        {"features", features}};
  out(collection.dump(1) + "\n");
}

}  // namespace cluxel
