// SPDX-License-Identifier: Apache-2.0
// A register of things, kept by others, beside what a map holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "tasks/inventory/inventory.hpp"

namespace cluxel::tasks {

struct RegisterEntry {
  std::string id, class_iri;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< [m, map]
  std::optional<double> height_m;
};

/// Reads a register. CSV: a header with the columns class (or kind), then x and y [m, map] or lon and lat [deg], and if
/// there are, id and height [m]. GeoJSON: points or lines with the properties class (or kind), id and height, in
/// longitude and latitude, in the map's coordinate system where the member "crs" names it, or in metres of the map
/// frame where the collection has the member "frame", whatever its value. Degrees need the map's coordinate system.
/// Classes are written as classNamed() takes them. The place of a line is that of the inventory: the middle one of its
/// points, of a parking row their mean. Throws InputError with the line or the feature of every fault.
std::vector<RegisterEntry> readRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                                        const rdf::OntologyView& ontology);
/// Reads lines with the property "name" from GeoJSON, in degrees or metres as a register. Notes how many features are
/// left out, as they have no name or no line. Throws InputError when none is left.
std::vector<Street> readStreets(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                                ProgressSink& sink);

enum class RegisterStatus : std::uint8_t {
  Matched,
  MissingInMap,   ///< its place was observed, and the map holds nothing of the class there
  NotObserved,    ///< no scan looked at its place from near enough
  NotInRegister,  ///< the map holds it and it is listed, the register does not hold it
};
const char* nameOf(RegisterStatus status);

struct RegisterParams {
  double within_m = 3;  ///< a pair is at most so far apart
  double view_m = 25;   ///< a place is observed when a scan looks at it from within this distance
};

struct RegisterRow {
  RegisterStatus status = RegisterStatus::Matched;
  std::optional<std::size_t> entry, item;  ///< numbers in what was given
  double distance_m = kNotMeasured;
};

/// A thing of the map that entries are compared with.
struct RegisterItem {
  InventoryItem thing;
  bool is_listed = false;              ///< it is of the inventory that was asked for
  std::set<std::string> classes = {};  ///< those classes of entries that it is of
};

struct RegisterItems {
  std::vector<RegisterItem> items;
  std::size_t rows_left_out = 0;  ///< as Inventory's
};
/// The inventory, then everything else in the map that is of a class of an entry: objects, their parts, and what rules
/// derived. What rules call an object counts beside its class.
RegisterItems registerItems(const mapping::MapReader& map, const InventoryParams& params,
                            const std::vector<RegisterEntry>& entries);

/// Pairs of an entry and a thing of its class or of a subclass, each once: those of the very class first, then nearest
/// first. Then what is left of the entries, as not observed, and of the listed things. In the order of the entries,
/// then of the items.
std::vector<RegisterRow> compareWith(const std::vector<RegisterEntry>& entries, const std::vector<RegisterItem>& items,
                                     const RegisterParams& params);
/// How high the thing of an entry is: as the entry says, else as the map's things of its class in the median, else the
/// least that is likely [m]. By entry.
std::vector<double> heightsOf(const std::vector<RegisterEntry>& entries, const std::vector<RegisterItem>& items);
/// Tells which of the rows that are not observed are missing in the map. Memory and cost as for observedPlaces().
void tellMissing(const mapping::MapReader& map, const std::vector<RegisterEntry>& entries,
                 const std::vector<RegisterItem>& items, const RegisterParams& params, std::vector<RegisterRow>& rows);

}  // namespace cluxel::tasks
