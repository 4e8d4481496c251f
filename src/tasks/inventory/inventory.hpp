// SPDX-License-Identifier: Apache-2.0
// What a town keeps lists of: signs, lamps and trees with their sizes, rows of parked vehicles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::tasks {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// One entry. Sizes that do not apply to its kind are kNotMeasured.
struct InventoryItem {
  std::string kind;  ///< local name of the class
  /// Of the object, or clx:ParkingRow or clx:Sidewalk; the class asked for where only a SPARQL rule gives it.
  std::string class_iri;
  std::string object;                            ///< IRI of the object or way; empty for a row
  std::string street;                            ///< name of the nearest street; empty: none is known near it
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< [m, map]; of a tree its trunk
  double height_m = kNotMeasured;                ///< top above the local ground
  double crown_m = kNotMeasured;                 ///< diameter of the circle that is as large as the crown from above
  double width_m = kNotMeasured, length_m = kNotMeasured;
  std::size_t count = 1;                   ///< vehicles of a row
  std::vector<Eigen::Vector2d> line = {};  ///< of rows and ways [m, map]
};

/// Whether it is a parking row: then `count` tells its vehicles.
inline bool isRow(const InventoryItem& item) {
  return item.kind == "ParkingRow";
}

/// A street by its name and course [m, map].
struct Street {
  std::string name;
  std::vector<Eigen::Vector2d> course;
};

struct InventoryParams {
  std::vector<std::string> classes{"StreetSign", "StreetLamp", "TrafficLight", "UtilityPole", "Tree"};
  double street_within_m = 25;  ///< what is farther from all streets belongs to none
  bool with_rows = true;        ///< also the parking rows of the map's rules
  bool with_sidewalks = true;   ///< also the ways that the rules call sidewalks
};

/// What is of the named classes, written as classNamed() takes them. clx:ParkingRow and clx:Sidewalk are the rows and
/// the sidewalks. The defaults without names. Throws Error (NotFound) for an unknown class, and as
/// requireClassOfObjects().
InventoryParams inventoryOfKinds(const mapping::MapReader& map, const std::vector<std::string>& kinds);

/// A parking row that lost vehicles is one as long as so many are left, whatever number the map's rule asks for: a rule
/// does not tell that number.
inline constexpr std::size_t kFewestInBrokenRow = 3;

struct Inventory {
  std::vector<InventoryItem> items;
  std::size_t rows_left_out = 0;  ///< parking rows that lost vehicles, and have fewer than kFewestInBrokenRow left
  double nearest_street_m = kNotMeasured;  ///< the smallest distance of an item from a street
};
/// The objects that objectsOfClass() tells, without those that later scans show to be gone. Objects first, by class and
/// IRI, then rows and sidewalks by place. Throws Error (NotFound) for an unknown class.
Inventory inventoryOf(const mapping::MapReader& map, const InventoryParams& params,
                      const std::vector<Street>& streets = {});

}  // namespace cluxel::tasks
