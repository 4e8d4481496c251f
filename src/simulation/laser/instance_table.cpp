// SPDX-License-Identifier: Apache-2.0
// Points per object are collected for each scan and merged in the order of the scans.
#include "simulation/laser/instance_table.hpp"

#include <algorithm>
#include <cstdio>

#include "base/ascii.hpp"
#include "base/convex_hull.hpp"
#include "simulation/site/campus_site.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

void merge(InstanceSight& into, const InstanceSight& part) {
  into.points += part.points;
  into.sum += part.sum;
  into.box.extend(part.box);
  into.outline.insert(into.outline.end(), part.outline.begin(), part.outline.end());
  into.outline = convexHull(std::move(into.outline));
  for (const auto& [label, count] : part.points_of_label) into.points_of_label[label] += count;
}

/// The reason why an object is ambiguous (not scored); empty when it is scored.
std::string reasonsAgainst(const CampusObject& object, const InstanceSight& sight, const FootprintBox& extents) {
  std::string reasons;
  const auto is = [&object](ObjectClass expected_class) {
    return object.class_number == static_cast<int>(expected_class);
  };
  const auto when = [&reasons](bool applies, const char* reason) {
    if (applies) reasons += std::string(reason) + ";";
  };
  const auto seen_label = [&sight](SurfaceLabel label) {
    return sight.points_of_label.contains(static_cast<std::uint32_t>(label));
  };
  when(is(ObjectClass::Ground), "ground");
  when(sight.points < (is(ObjectClass::Building) ? 200U : 20U), "few points");
  when(sight.box.sizes().z() < 0.5 * object.box.sizes().z(), "mostly hidden");
  when(is(ObjectClass::Building) && extents.length_m > 40, "longer than 40 m");
  when(is(ObjectClass::Tree) && (!seen_label(SurfaceLabel::TreeTrunk) || !seen_label(SurfaceLabel::TreeTop)),
       "trunk or top unseen");
  when(is(ObjectClass::Bush) && extents.length_m > 5, "hedge");
  when(is(ObjectClass::StreetSign) && !seen_label(SurfaceLabel::SignPlate), "plate unseen");
  when(is(ObjectClass::Vehicle) && extents.length_m < 1, "shorter than 1 m");
  when(object.kind == "fence" || object.kind == "bollard", "fence or post");
  return reasons;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

template <typename Counts, typename NameOf>
std::string joinCounts(const Counts& counts, const char* separator, const NameOf& nameOf) {
  std::string text;
  for (const auto& [key, count] : counts) {
    if (!text.empty()) text += separator;
    text += nameOf(key) + ":" + std::to_string(count);
  }
  return text;
}

/// The class as truth files write it: StreetLamp becomes street_lamp.
std::string snakeCase(const std::string& name) {
  std::string snake;
  for (const char letter : name) {
    if (lowerAscii(letter) != letter && !snake.empty()) snake += '_';
    snake += lowerAscii(letter);
  }
  return snake;
}

}  // namespace

InstanceSights sightsOf(const SimulatedScan& simulated) {
  InstanceSights sights;
  std::map<std::int32_t, std::vector<Vector2d>> seen_from_above;
  const scan::ScanPoints& points = simulated.scan.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t id = simulated.truth.instance[i];
    if (id < 0) continue;
    const Vector3d p_map = scan::toMap(simulated.scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
    InstanceSight& sight = sights[id];
    ++sight.points;
    sight.sum += p_map;
    sight.box.extend(p_map);
    ++sight.points_of_label[points.label[i]];
    seen_from_above[id].push_back(p_map.head<2>());
  }
  for (auto& [id, outline] : seen_from_above) sights[id].outline = convexHull(std::move(outline));
  return sights;
}

std::string instanceTable(const Campus& campus, const std::vector<InstanceSights>& sights,
                          const std::vector<std::string>& scans) {
  InstanceSights all;
  std::map<std::int32_t, std::map<std::size_t, std::size_t>> points_in_scan;
  for (std::size_t scan = 0; scan < sights.size(); ++scan)
    for (const auto& [id, sight] : sights[scan]) {
      merge(all[id], sight);
      points_in_scan[id][scan] = sight.points;
    }
  std::string table =
      "id,object,n,cx,cy,cz,xmin,ymin,zmin,xmax,ymax,zmax,height,extent_long,extent_short,chunks,"
      "fine_labels,ambiguous,flags\n";
  for (const auto& [id, sight] : all) {
    const CampusObject& object = campus.objects[static_cast<std::size_t>(id)];
    const FootprintBox extents = smallestBox(sight.outline);
    const std::string reasons = reasonsAgainst(object, sight, extents);
    table += std::to_string(id) + "," +
             snakeCase(scan::truthClassNames()[static_cast<std::size_t>(object.class_number)]) + "," +
             std::to_string(sight.points);
    for (const Vector3d& corner :
         {Vector3d(sight.sum / static_cast<double>(sight.points)), sight.box.min(), sight.box.max()})
      for (int axis = 0; axis < 3; ++axis) table += "," + number(corner[axis]);
    table += "," + number(sight.box.sizes().z()) + "," + number(extents.length_m) + "," + number(extents.width_m) +
             "," + joinCounts(points_in_scan[id], "+", [&scans](std::size_t scan) { return scans[scan]; }) + "," +
             joinCounts(sight.points_of_label, "+", [](std::uint32_t label) { return std::to_string(label); }) + "," +
             (reasons.empty() ? "0" : "1") + "," + reasons + "\n";
  }
  return table;
}

}  // namespace cluxel::simulation
