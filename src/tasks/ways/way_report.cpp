// SPDX-License-Identifier: Apache-2.0
// Writes routes and reach.
#include "tasks/ways/way_report.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "rdf/map_iris.hpp"
#include "tasks/export/footprint_export.hpp"

namespace cluxel::tasks {

namespace {

using WayJson = nlohmann::ordered_json;

double rounded3(double value) {
  return std::round(value * 1000) / 1000;
}

std::string metresText(const char* format, double value) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

const char* kindName(Barrier::Kind kind) {
  switch (kind) {
    case Barrier::Kind::Unobserved:
      return "unobserved";
    case Barrier::Kind::Obstacle:
      return "thing";
    case Barrier::Kind::TooSteep:
      return "too steep";
    case Barrier::Kind::TooNarrow:
      return "too narrow";
    case Barrier::Kind::Step:
      return "step";
  }
  return "";
}

WayJson numbersOf(const Route& route) {
  WayJson json{{"length", rounded3(route.length_m)},
               {"cost", rounded3(route.cost)},
               {"climb", rounded3(route.climb_m)},
               {"steepest", rounded3(route.steepest)},
               {"highestStep", rounded3(route.highest_step_m)}};
  if (std::isfinite(route.narrowest_m)) json["narrowest"] = rounded3(route.narrowest_m);
  return json;
}

WayJson barrierJson(const mapping::MapReader& map, const Barrier& barrier) {
  WayJson json{{"kind", kindName(barrier.kind)},
               {"text", barrierText(map, barrier)},
               {"at", {rounded3(barrier.at.x()), rounded3(barrier.at.y())}},
               {"length", rounded3(barrier.length_m)}};
  if (barrier.measured > 0) json["measured"] = rounded3(barrier.measured);
  if (barrier.thing != kUnnamedThing) json["object"] = rdf::iriOfObject(map.objectIds()[barrier.thing]);
  return json;
}

}  // namespace

std::vector<Eigen::Vector2d> cornersOf(const GridFrame& frame, const std::vector<std::uint32_t>& cells) {
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool is_inner = i > 0 && i + 1 < cells.size();
    if (is_inner && cells[i] - cells[i - 1] == cells[i + 1] - cells[i]) continue;
    corners.push_back(frame.centreOf(cells[i]));
  }
  return corners;
}

std::string thingName(const mapping::MapReader& map, std::uint32_t thing) {
  if (thing == kUnnamedThing) return "something unnamed";
  constexpr std::size_t digits = 12;
  return map.classNames().nameOf(map.classOf(thing)) + " object/" + map.objectIds()[thing].hex().substr(0, digits);
}

std::string barrierText(const mapping::MapReader& map, const Barrier& barrier) {
  std::string text;
  switch (barrier.kind) {
    case Barrier::Kind::Unobserved:
      text = "ground that was not observed";
      break;
    case Barrier::Kind::Obstacle:
      text = thingName(map, barrier.thing);
      break;
    case Barrier::Kind::TooSteep:
      text = metresText("a slope of %.0f %%", barrier.measured * 100);
      break;
    case Barrier::Kind::TooNarrow:
      text = metresText("only %.2f m wide beside ", barrier.measured) + thingName(map, barrier.thing);
      break;
    case Barrier::Kind::Step:
      text = metresText("a step of %.2f m", barrier.measured);
      break;
  }
  return text + metresText(" at (%.1f, ", barrier.at.x()) + metresText("%.1f)", barrier.at.y()) +
         metresText(", for %.1f m", barrier.length_m);
}

std::string routesJson(const mapping::MapReader& map, const GridFrame& frame, const RouteAnswer& answer) {
  WayJson json{{"routes", WayJson::array()}, {"barriers", WayJson::array()}};
  for (const Route& route : answer.routes) {
    WayJson entry = numbersOf(route);
    entry["places"] = WayJson::array();
    for (const Eigen::Vector2d& p : cornersOf(frame, route.cells)) entry["places"].push_back({p.x(), p.y()});
    json["routes"].push_back(std::move(entry));
  }
  for (const Barrier& barrier : answer.barriers) json["barriers"].push_back(barrierJson(map, barrier));
  return json.dump(2);
}

std::string routesGeoJson(const mapping::MapReader& map, const GridFrame& frame, const RouteAnswer& answer,
                          ExportFrame coordinates) {
  const PlaceWriter position = placesIn(coordinates, map.inputs());
  WayJson features = WayJson::array();
  for (const Route& route : answer.routes) {
    WayJson line = WayJson::array();
    for (const Eigen::Vector2d& p : cornersOf(frame, route.cells)) {
      const Eigen::Vector2d place = position(p);
      line.push_back({place.x(), place.y()});
    }
    if (line.size() == 1) line.push_back(line.front());  // a LineString has two places or more
    features.push_back({{"type", "Feature"},
                        {"geometry", {{"type", "LineString"}, {"coordinates", std::move(line)}}},
                        {"properties", numbersOf(route)}});
  }
  WayJson collection{{"type", "FeatureCollection"}};
  if (coordinates == ExportFrame::Local)
    collection["frame"] = "map frame of Cluxel, metres: not longitude and latitude";
  collection["features"] = std::move(features);
  return collection.dump(1);
}

std::string reachJson(const mapping::MapReader& map, const std::vector<ReachedObject>& reached, double area_m2,
                      double speed_m_s) {
  WayJson json{{"area", rounded3(area_m2)}, {"objects", WayJson::array()}};
  for (const ReachedObject& entry : reached) {
    json["objects"].push_back({{"object", rdf::iriOfObject(map.objectIds()[entry.object])},
                               {"class", map.classNames().nameOf(map.objectClasses()[entry.object])},
                               {"walk", rounded3(entry.walk_m)},
                               {"seconds", rounded3(entry.walk_m / speed_m_s)}});
  }
  return json.dump(2);
}

}  // namespace cluxel::tasks
