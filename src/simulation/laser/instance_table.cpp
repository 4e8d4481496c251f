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

/// "a:3+b:5"
template <typename Counts, typename NameOf>
std::string joinCounts(const Counts& counts, const NameOf& nameOf) {
  std::string text;
  for (const auto& [key, count] : counts) {
    if (!text.empty()) text += '+';
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

void SeenObjects::add(const InstanceSights& sights, const std::string& scan) {
  for (const auto& [id, sight] : sights) {
    SeenObject& object = objects_[id];
    merge(object.sight, sight);
    object.points_in_scan.emplace_back(scan, sight.points);
  }
}

std::string instanceHeader() {
  return "id,object,n,cx,cy,cz,xmin,ymin,zmin,xmax,ymax,zmax,height,extent_long,extent_short,chunks,"
         "fine_labels,ambiguous,flags\n";
}

std::string instanceRow(std::int32_t id, const CampusObject& object, const SeenObject& seen) {
  const InstanceSight& sight = seen.sight;
  const FootprintBox extents = smallestBox(sight.outline);
  const std::string reasons = reasonsAgainst(object, sight, extents);
  std::string row = std::to_string(id) + "," +
                    snakeCase(scan::truthClassNames()[static_cast<std::size_t>(object.class_number)]) + "," +
                    std::to_string(sight.points);
  for (const Vector3d& corner :
       {Vector3d(sight.sum / static_cast<double>(sight.points)), sight.box.min(), sight.box.max()})
    for (int axis = 0; axis < 3; ++axis) row += "," + number(corner[axis]);
  row += "," + number(sight.box.sizes().z()) + "," + number(extents.length_m) + "," + number(extents.width_m);
  row += "," + joinCounts(seen.points_in_scan, [](const std::string& scan) { return scan; });
  row += "," + joinCounts(sight.points_of_label, [](std::uint32_t label) { return std::to_string(label); });
  return row + "," + (reasons.empty() ? "0" : "1") + "," + reasons + "\n";
}

std::string instanceTable(const Campus& campus, const SeenObjects& seen) {
  std::string table = instanceHeader();
  for (const auto& [id, object] : seen.all())
    table += instanceRow(id, campus.objects[static_cast<std::size_t>(id)], object);
  return table;
}

}  // namespace cluxel::simulation
