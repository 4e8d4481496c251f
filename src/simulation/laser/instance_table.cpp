// SPDX-License-Identifier: Apache-2.0
// Points per object are collected for each scan and merged in the order of the scans.
#include "simulation/laser/instance_table.hpp"

#include <algorithm>
#include <cstdio>

#include "simulation/site/campus_site.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Andrew's monotone chain.
std::vector<Vector2d> convexHull(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(),
            [](const Vector2d& a, const Vector2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  if (points.size() < 3) return points;
  std::vector<Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Vector2d& point : points) {
      while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// Long and short side of the smallest rectangle around a hull.
Vector2d extentsOf(const std::vector<Vector2d>& hull) {
  Vector2d best{0, 0};
  double best_area = 1e300;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    if (edge.norm() == 0) continue;
    const Vector2d u = edge.normalized(), v{-u.y(), u.x()};
    Eigen::AlignedBox2d box;
    for (const Vector2d& point : hull) box.extend(Vector2d{u.dot(point), v.dot(point)});
    const Vector2d size = box.sizes();
    if (size.prod() >= best_area) continue;
    best_area = size.prod();
    best = {size.maxCoeff(), size.minCoeff()};
  }
  return best;
}

void merge(InstanceSight& into, const InstanceSight& part) {
  into.points += part.points;
  into.sum += part.sum;
  into.box.extend(part.box);
  into.outline.insert(into.outline.end(), part.outline.begin(), part.outline.end());
  into.outline = convexHull(std::move(into.outline));
  for (const auto& [label, count] : part.points_of_label) into.points_of_label[label] += count;
}

/// The reason why an object is ambiguous (not scored); empty when it is scored.
std::string reasonsAgainst(const CampusObject& object, const InstanceSight& sight, const Vector2d& extents) {
  std::string reasons;
  const auto is = [&object](ObjectClass wanted) { return object.class_number == static_cast<int>(wanted); };
  const auto when = [&reasons](bool applies, const char* reason) {
    if (applies) reasons += std::string(reason) + ";";
  };
  const auto seen_label = [&sight](SurfaceLabel label) {
    return sight.points_of_label.contains(static_cast<std::uint32_t>(label));
  };
  when(is(ObjectClass::Ground), "ground");
  when(sight.points < (is(ObjectClass::Building) ? 200U : 20U), "few points");
  when(sight.box.sizes().z() < 0.5 * object.box.sizes().z(), "mostly hidden");
  when(is(ObjectClass::Building) && extents.x() > 40, "longer than 40 m");
  when(is(ObjectClass::Tree) && (!seen_label(SurfaceLabel::TreeTrunk) || !seen_label(SurfaceLabel::TreeTop)),
       "trunk or top unseen");
  when(is(ObjectClass::Bush) && extents.x() > 5, "hedge");
  when(is(ObjectClass::StreetSign) && !seen_label(SurfaceLabel::SignPlate), "plate unseen");
  when(is(ObjectClass::Vehicle) && extents.x() < 1, "shorter than 1 m");
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
    const bool capital = letter >= 'A' && letter <= 'Z';
    if (capital && !snake.empty()) snake += '_';
    snake += capital ? static_cast<char>(letter - 'A' + 'a') : letter;
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
    const Vector2d extents = extentsOf(sight.outline);
    const std::string reasons = reasonsAgainst(object, sight, extents);
    table += std::to_string(id) + "," +
             snakeCase(scan::truthClassNames()[static_cast<std::size_t>(object.class_number)]) + "," +
             std::to_string(sight.points);
    for (const Vector3d& corner :
         {Vector3d(sight.sum / static_cast<double>(sight.points)), sight.box.min(), sight.box.max()})
      for (int axis = 0; axis < 3; ++axis) table += "," + number(corner[axis]);
    table += "," + number(sight.box.sizes().z()) + "," + number(extents.x()) + "," + number(extents.y()) + "," +
             joinCounts(points_in_scan[id], "+", [&scans](std::size_t scan) { return scans[scan]; }) + "," +
             joinCounts(sight.points_of_label, "+", [](std::uint32_t label) { return std::to_string(label); }) + "," +
             (reasons.empty() ? "0" : "1") + "," + reasons + "\n";
  }
  return table;
}

}  // namespace cluxel::simulation
