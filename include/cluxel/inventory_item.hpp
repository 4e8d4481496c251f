// SPDX-License-Identifier: Apache-2.0
// What a town keeps lists of: signs, lamps and trees with their sizes, rows of parked vehicles, sidewalks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/object.hpp"

namespace cluxel {

struct InventoryOptions {
  /// Classes, named as for Map::objects(), "ParkingRow" and "Sidewalk". Empty: street signs, street lamps, traffic
  /// lights, utility poles, trees, and both of these.
  std::vector<std::string> kinds = {};
  /// GeoJSON lines with the property "name", in degrees where the map has a coordinate system. Empty: no streets.
  std::filesystem::path streets = {};
};

/// One entry. Sizes are absent where they do not apply to its kind.
struct InventoryItem {
  std::string kind;                          ///< local name of its class: "Tree", "ParkingRow"
  std::string class_iri;                     ///< of the object, or clx:ParkingRow or clx:Sidewalk
  std::string object;                        ///< IRI of the object or way; empty for a row
  std::string street;                        ///< name of the nearest street; empty: none within 25 m
  GroundPosition at;                         ///< of a tree its trunk
  std::optional<double> height_m;            ///< top above the local ground
  std::optional<double> crown_m;             ///< diameter of the circle that is as large as the crown from above
  std::optional<double> width_m;             ///< of a row; of a sidewalk the median across it
  std::optional<double> length_m;            ///< of a row or sidewalk
  std::optional<std::size_t> vehicle_count;  ///< of a row
  std::vector<GroundPosition> line;          ///< of rows and sidewalks: their course
};

struct Inventory {
  std::vector<InventoryItem> items;  ///< objects by class and IRI, then rows and sidewalks by place
  /// What a person should know, a sentence each: what is not listed and why, streets that are all far away, features
  /// of the file of streets that are left out.
  std::vector<std::string> notes;
};

}  // namespace cluxel
