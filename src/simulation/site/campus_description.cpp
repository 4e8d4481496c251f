// SPDX-License-Identifier: Apache-2.0
// The campus as JSON.
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "scan/truth/truth.hpp"
#include "simulation/site/campus.hpp"

namespace cluxel::simulation {
namespace {

using Json = nlohmann::ordered_json;

Json vectorJson(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

/// Newer parameters are written only when they differ from their default, so that files of other campuses stay
/// identical.
bool isAlwaysSaid(const CampusParamInfo& info) {
  return info.field != &CampusParams::stop_distance_m && info.field != &CampusParams::drift_m &&
         info.field != &CampusParams::visits && info.field != &CampusParams::later_stops &&
         info.field != &CampusParams::pose_error_m;
}

Json parametersJson(const CampusParams& params) {
  Json json{{"seed", params.seed}};
  for (const CampusParamInfo& info : campusParamInfos())
    if (isAlwaysSaid(info) || params.*info.field != CampusParams{}.*info.field)
      json[std::string(info.name)] = params.*info.field;
  if (params.laser == LaserKind::Spinning) json["laser"] = "spinning";
  return json;
}

Json surfacesJson() {
  Json surfaces = Json::array();
  for (const SurfaceInfo& info : surfaceInfos()) {
    Json surface{{"label", static_cast<std::uint32_t>(info.label)}, {"name", info.name}};
    surface["primitive"] = info.primitive ? Json(nameOf(*info.primitive)) : Json(nullptr);
    surface["class"] = info.object_class.empty() ? Json(nullptr) : Json(info.object_class);
    if (!info.part.empty()) surface["part"] = info.part;
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

Json objectsJson(const Campus& campus) {
  std::map<std::int32_t, std::set<std::string>> surfaces_of;
  for (const CampusMesh& mesh : campus.meshes) surfaces_of[mesh.instance].insert(std::string(infoOf(mesh.label).name));
  Json objects = Json::array();
  for (std::size_t i = 0; i < campus.objects.size(); ++i) {
    const CampusObject& object = campus.objects[i];
    Json json{{"instance", i},
              {"class", scan::truthClassNames()[static_cast<std::size_t>(object.class_number)]},
              {"kind", object.kind},
              {"position_m", vectorJson(object.position)},
              {"box_min_m", vectorJson(object.box.min())},
              {"box_max_m", vectorJson(object.box.max())},
              {"surfaces", surfaces_of[static_cast<std::int32_t>(i)]}};
    if (!object.traits.empty()) json["traits"] = object.traits;
    objects.push_back(std::move(json));
  }
  return objects;
}

}  // namespace

std::string describeCampus(const Campus& campus) {
  Json stops = Json::array();
  for (const auto& T_map_sensor : campus.stops) stops.push_back(vectorJson(T_map_sensor.translation()));
  const Json json{{"generated", true},
                  {"parameters", parametersJson(campus.params)},
                  {"heading_rad", campus.heading_rad},
                  {"stops_m", stops},
                  {"surfaces", surfacesJson()},
                  {"objects", objectsJson(campus)}};
  return json.dump(1) + "\n";
}

}  // namespace cluxel::simulation
