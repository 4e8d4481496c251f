// SPDX-License-Identifier: Apache-2.0
// Measures objects, and lists rows of vehicles and sidewalks.
#include "tasks/inventory/inventory.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <tuple>

#include "base/convex_hull.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/regions/whole_objects.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/named_class.hpp"
#include "tasks/objects_of_class.hpp"

namespace cluxel::tasks {

namespace {

double hullArea(const std::vector<Eigen::Vector2d>& hull) {
  double twice = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

/// The cluxels of the parts of a class; all of the object's when it has no such part.
std::vector<std::uint32_t> partCluxels(const rules::SemanticObject& object, const std::string& part_class) {
  std::vector<std::uint32_t> members;
  for (const rules::ObjectPart& part : object.parts)
    if (part.part_class == part_class) members.insert(members.end(), part.cluxels.begin(), part.cluxels.end());
  return members.empty() ? mapping::cluxelsOf(object) : members;
}

double crownDiameter(const rules::SemanticObject& tree, const perception::SceneCluxels& cluxels) {
  std::vector<Eigen::Vector2d> corners;
  for (const std::uint32_t c : partCluxels(tree, rdf::vocabulary::clx("TreeTop"))) {
    const Eigen::Vector2d low = cluxels.low_corner[c].head<2>();
    const Eigen::Vector2d high = low + cluxels.extent[c].head<2>().cast<double>();
    corners.insert(corners.end(), {low, {high.x(), low.y()}, {low.x(), high.y()}, high});
  }
  return 2 * std::sqrt(hullArea(convexHull(std::move(corners))) / std::numbers::pi);
}

double distanceToCourse(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& course) {
  double nearest = course.empty() ? 1e300 : (p - course.front()).norm();
  for (std::size_t i = 1; i < course.size(); ++i) {
    const Eigen::Vector2d along = course[i] - course[i - 1];
    const double share = std::clamp((p - course[i - 1]).dot(along) / std::max(1e-12, along.squaredNorm()), 0.0, 1.0);
    nearest = std::min(nearest, (course[i - 1] + share * along - p).norm());
  }
  return nearest;
}

struct NearestStreet {
  std::string name;
  double distance_m = std::numeric_limits<double>::infinity();
};

NearestStreet nearestStreet(const Eigen::Vector2d& p, const std::vector<Street>& streets) {
  NearestStreet nearest;
  for (const Street& street : streets) {
    const double distance = distanceToCourse(p, street.course);
    if (distance < nearest.distance_m) nearest = {street.name, distance};
  }
  return nearest;
}

/// Names the street of each item. Returns the smallest distance.
double assignStreets(std::vector<InventoryItem>& items, const std::vector<Street>& streets, double within_m) {
  if (items.empty() || streets.empty()) return kNotMeasured;
  double least = std::numeric_limits<double>::infinity();
  for (InventoryItem& item : items) {
    const NearestStreet nearest = nearestStreet(item.at, streets);
    if (nearest.distance_m <= within_m) item.street = nearest.name;
    least = std::min(least, nearest.distance_m);
  }
  return least;
}

struct ParkedVehicle {
  Eigen::Vector2d at;
  double heading_rad = 0, length_m = 0, width_m = 0;
};

/// The angle between two directions without sense, in [0, pi/2].
double turnBetween(double a_rad, double b_rad) {
  const double turn = std::abs(std::remainder(a_rad - b_rad, std::numbers::pi));
  return turn;
}

InventoryItem rowOf(std::vector<ParkedVehicle> vehicles) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const ParkedVehicle& vehicle : vehicles) middle += vehicle.at / static_cast<double>(vehicles.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const ParkedVehicle& vehicle : vehicles) spread += (vehicle.at - middle) * (vehicle.at - middle).transpose();
  const double angle = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
  std::sort(vehicles.begin(), vehicles.end(),
            [&](const auto& a, const auto& b) { return a.at.dot(along) < b.at.dot(along); });
  InventoryItem row;
  row.kind = "ParkingRow";
  row.class_iri = rdf::vocabulary::clx(row.kind);
  row.at = middle;
  row.count = vehicles.size();
  for (const ParkedVehicle& vehicle : vehicles) row.line.push_back(vehicle.at);
  row.length_m = (vehicles.back().at - vehicles.front().at).dot(along);
  row.width_m = 0;
  for (const ParkedVehicle& vehicle : vehicles) {
    const bool is_along = turnBetween(vehicle.heading_rad, angle) < std::numbers::pi / 4;
    row.width_m = std::max(row.width_m, is_along ? vehicle.width_m : vehicle.length_m);
  }
  return row;
}

/// Those that the map holds and that are not gone.
std::map<std::string, ParkedVehicle> parkedNamed(const mapping::MapReader& map, const std::set<std::string>& names) {
  const std::vector<bool> is_gone = goneAmong(map);
  std::vector<bool> is_wanted;
  for (std::size_t i = 0; i < is_gone.size(); ++i)
    is_wanted.push_back(!is_gone[i] && names.contains(rdf::iriOfObject(map.objectIds()[i])));
  std::map<std::string, ParkedVehicle> parked;
  mapping::forEachWholeObject(map, is_wanted, [&](const mapping::WholeObject& whole) {
    const auto box = mapping::geometryOf(whole.cluxels, mapping::cluxelsOf(whole.object)).box;
    parked[rdf::iriOfObject(whole.object.id)] = {box.center.head<2>(), box.yaw_rad, box.size.x(), box.size.y()};
  });
  return parked;
}

/// The rows that the map's rules derived, and what stands in them.
Inventory parkingRows(const mapping::MapReader& map) {
  const sparql::ResultTable members =
      sparql::evaluateQuery(map.quads(),
                            "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) +
                                "> SELECT ?row ?vehicle { ?row a clx:ParkingRow ; clx:hasMember ?vehicle } "
                                "ORDER BY ?row ?vehicle")
          .table;
  std::set<std::string> names;
  for (std::size_t i = 0; i < members.row_count; ++i) names.insert(members.at(i, 1)->text);
  const std::map<std::string, ParkedVehicle> known = parkedNamed(map, names);
  std::map<std::string, std::vector<ParkedVehicle>> rows;
  std::set<std::string> lost_some;
  for (std::size_t i = 0; i < members.row_count; ++i) {
    std::vector<ParkedVehicle>& row = rows[members.at(i, 0)->text];
    if (const auto vehicle = known.find(members.at(i, 1)->text); vehicle != known.end())
      row.push_back(vehicle->second);
    else
      lost_some.insert(members.at(i, 0)->text);
  }
  Inventory found;
  for (auto& [iri, vehicles] : rows) {
    if (lost_some.contains(iri) && vehicles.size() < kFewestInBrokenRow)
      ++found.rows_left_out;
    else
      found.items.push_back(rowOf(std::move(vehicles)));
  }
  return found;
}

/// The sidewalks among the ways that the map holds.
std::vector<InventoryItem> sidewalksOf(const mapping::MapReader& map) {
  const sparql::ResultTable ways =
      sparql::evaluateQuery(
          map.quads(), "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) + "> PREFIX geo: <" +
                           std::string(rdf::vocabulary::kGeo) +
                           "> SELECT ?way ?x ?y ?length ?width ?line { ?way a clx:Sidewalk ; clx:x ?x ; clx:y ?y ; "
                           "clx:length ?length ; clx:width ?width ; geo:hasGeometry/geo:asWKT ?line } ORDER BY ?way")
          .table;
  std::vector<InventoryItem> found;
  for (std::size_t i = 0; i < ways.row_count; ++i) {
    const auto number = [&](std::size_t column) { return std::stod(ways.at(i, column)->text); };
    InventoryItem& item = found.emplace_back();
    item.kind = "Sidewalk";
    item.class_iri = rdf::vocabulary::clx(item.kind);
    item.object = ways.at(i, 0)->text;
    item.at = {number(1), number(2)};
    item.length_m = number(3);
    item.width_m = number(4);
    std::string line = ways.at(i, 5)->text;
    for (char& c : line)
      if (c == ',' || c == '(' || c == ')') c = ' ';
    std::istringstream words(line);
    std::string shape;
    words >> shape;  // LINESTRING
    for (Eigen::Vector2d p; words >> p.x() >> p.y();) item.line.push_back(p);
  }
  return found;
}

/// How an object is listed.
struct Listing {
  std::string class_iri;
  bool is_tree = false;  ///< by its own class, whatever class was asked for
};

InventoryItem measuredItem(const mapping::MapReader& map, const mapping::WholeObject& whole, const Listing& listing) {
  const auto& [number, object, cluxels] = whole;
  InventoryItem item;
  item.kind = map.classNames().nameOf(listing.class_iri);
  item.class_iri = listing.class_iri;
  item.object = rdf::iriOfObject(object.id);
  item.height_m = mapping::geometryOf(cluxels, mapping::cluxelsOf(object)).top_m;
  item.at = mapping::geometryOf(cluxels, partCluxels(object, rdf::vocabulary::clx("TreeTrunk"))).centroid.head<2>();
  if (listing.is_tree) item.crown_m = crownDiameter(object, cluxels);
  return item;
}

/// What to list, by its numbers in MapReader::objects(), each with the class that it is listed as: its own when that is
/// one of the classes or below one, else the first of them that the map says it is of.
std::map<std::uint32_t, Listing> listedObjects(const mapping::MapReader& map, const std::vector<std::string>& classes) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  const std::vector<bool> is_gone = goneAmong(map);
  std::map<std::uint32_t, Listing> listed;
  for (const std::string& name : classes) {
    const std::string class_iri = classNamed(map, ontology, name);
    for (const std::uint32_t object : objectsOfClass(map, class_iri)) {
      if (is_gone[object]) continue;
      const std::string& own = map.objectClasses()[object];
      Listing& listing = listed[object];
      listing.is_tree = ontology.isA(own, rdf::vocabulary::clx("Tree"));
      if (ontology.isA(own, class_iri))
        listing.class_iri = own;
      else if (listing.class_iri.empty())
        listing.class_iri = class_iri;
    }
  }
  return listed;
}

/// The objects without their streets, by number. Memory and cost as for forEachWholeObject().
std::vector<InventoryItem> measuredItems(const mapping::MapReader& map,
                                         const std::map<std::uint32_t, Listing>& listed) {
  std::vector<bool> is_wanted(map.objectIds().size(), false);
  for (const auto& [number, listing] : listed) is_wanted[number] = true;
  std::map<std::uint32_t, InventoryItem> by_number;
  mapping::forEachWholeObject(map, is_wanted, [&](const mapping::WholeObject& whole) {
    by_number.emplace(whole.number, measuredItem(map, whole, listed.at(whole.number)));
  });
  std::vector<InventoryItem> items;
  for (auto& [number, item] : by_number) items.push_back(std::move(item));
  return items;
}

}  // namespace

InventoryParams inventoryOfKinds(const mapping::MapReader& map, const std::vector<std::string>& kinds) {
  InventoryParams params;
  if (kinds.empty()) return params;
  params.classes.clear();
  params.with_rows = params.with_sidewalks = false;
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  for (const std::string& kind : kinds) {
    const std::string iri = classNamed(map, ontology, kind);
    if (iri == rdf::vocabulary::clx("ParkingRow")) {
      params.with_rows = true;
    } else if (iri == rdf::vocabulary::clx("Sidewalk")) {
      params.with_sidewalks = true;
    } else {
      requireClassOfObjects(map, ontology, iri);
      params.classes.push_back(iri);
    }
  }
  return params;
}

Inventory inventoryOf(const mapping::MapReader& map, const InventoryParams& params,
                      const std::vector<Street>& streets) {
  std::vector<InventoryItem> items = measuredItems(map, listedObjects(map, params.classes));
  std::stable_sort(items.begin(), items.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  Inventory rows;
  if (params.with_rows) rows = parkingRows(map);
  std::vector<InventoryItem> derived = std::move(rows.items);
  if (params.with_sidewalks) {
    const std::vector<InventoryItem> sidewalks = sidewalksOf(map);
    derived.insert(derived.end(), sidewalks.begin(), sidewalks.end());
  }
  std::stable_sort(derived.begin(), derived.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.kind, a.at.x(), a.at.y()) < std::tuple(b.kind, b.at.x(), b.at.y());
  });
  items.insert(items.end(), derived.begin(), derived.end());
  const double nearest_m = assignStreets(items, streets, params.street_within_m);
  return {std::move(items), rows.rows_left_out, nearest_m};
}

}  // namespace cluxel::tasks
