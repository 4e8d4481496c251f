// SPDX-License-Identifier: Apache-2.0
// The campus as JSON.
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "scan/truth/truth.hpp"
#include "simulation/site/campus.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

Json vectorJson(const Vector3d& v) {
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

/// A place of the campus in the frame of the map. Without a district it is there already.
Vector3d inMap(const Vector3d& place, const DistrictPlace* district) {
  return district == nullptr ? place : Vector3d(place + district->origin_map);
}

Json objectsJson(const Campus& campus, const DistrictPlace* district) {
  const std::size_t first = district == nullptr ? 0 : static_cast<std::size_t>(district->first_instance);
  std::map<std::int32_t, std::set<std::string>> surfaces_of;
  for (const CampusMesh& mesh : campus.meshes) surfaces_of[mesh.instance].insert(std::string(infoOf(mesh.label).name));
  Json objects = Json::array();
  for (std::size_t i = 0; i < campus.objects.size(); ++i) {
    const CampusObject& object = campus.objects[i];
    Json json{{"instance", first + i},
              {"class", scan::truthClassNames()[static_cast<std::size_t>(object.class_number)]},
              {"kind", object.kind},
              {"position_m", vectorJson(inMap(object.position, district))},
              {"box_min_m", vectorJson(inMap(object.box.min(), district))},
              {"box_max_m", vectorJson(inMap(object.box.max(), district))},
              {"surfaces", surfaces_of[static_cast<std::int32_t>(i)]}};
    if (!object.traits.empty()) json["traits"] = object.traits;
    objects.push_back(std::move(json));
  }
  return objects;
}

std::string description(const Campus& campus, const DistrictPlace* district) {
  Json stops = Json::array();
  for (const auto& T_map_sensor : campus.stops)
    stops.push_back(vectorJson(inMap(T_map_sensor.translation(), district)));
  Json json{{"generated", true}, {"parameters", parametersJson(campus.params)}};
  if (district != nullptr)
    json["district"] = {{"city_seed", district->city_seed},
                        {"number", district->number},
                        {"column", district->column},
                        {"row", district->row},
                        {"origin_m", vectorJson(district->origin_map)}};
  json["heading_rad"] = campus.heading_rad;
  json["stops_m"] = stops;
  json["surfaces"] = surfacesJson();
  json["objects"] = objectsJson(campus, district);
  return json.dump(1) + "\n";
}

}  // namespace

std::string describeCampus(const Campus& campus) {
  return description(campus, nullptr);
}

std::string describeDistrict(const Campus& campus, const DistrictPlace& place) {
  return description(campus, &place);
}

}  // namespace cluxel::simulation
