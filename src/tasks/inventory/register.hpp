// SPDX-License-Identifier: Apache-2.0
// A register of things, kept by others, beside what a map holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tasks/inventory/inventory.hpp"

namespace cluxel::tasks {

struct RegisterEntry {
  std::string id, kind;                          ///< kind: local name of a class
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< [m, map]
  std::optional<double> height_m;
};

/// Reads a register. CSV: a header with the columns class (or kind), then x and y [m, map] or lon and lat [deg], and if
/// there are, id and height [m]. GeoJSON: points with the properties class (or kind), id and height, in longitude and
/// latitude, or in metres where the collection has the member "frame" as Cluxel writes it. Degrees need the map's
/// coordinate system. Throws InputError with the line or the feature of every fault.
std::vector<RegisterEntry> readRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs);
/// Reads lines with the property "name" from GeoJSON, likewise.
std::vector<Street> readStreets(const std::filesystem::path& file, const mapping::MapInputs& inputs);

enum class RegisterStatus : std::uint8_t {
  Matched,
  MissingInMap,   ///< its place was observed, and the map holds nothing of the class there
  NotObserved,    ///< no scan saw its place from near enough
  NotInRegister,  ///< the map holds it, the register does not
};
const char* nameOf(RegisterStatus status);

struct RegisterParams {
  double within_m = 3;  ///< a pair is at most so far apart
  double view_m = 25;   ///< a place is observed when a scan sees it from within this distance
};

struct RegisterRow {
  RegisterStatus status = RegisterStatus::Matched;
  std::optional<std::size_t> entry, item;  ///< numbers in what was given
  double distance_m = kNotMeasured;
};

/// Pairs of one kind, nearest first, each entry and item once; then what is left. In the order of the entries, then of
/// the items. `is_observed`: per entry.
std::vector<RegisterRow> compareWith(const std::vector<RegisterEntry>& entries, const std::vector<InventoryItem>& items,
                                     const std::vector<bool>& is_observed, const RegisterParams& params);
std::vector<bool> observedPlaces(const mapping::MapReader& map, const std::vector<RegisterEntry>& entries,
                                 const RegisterParams& params);

}  // namespace cluxel::tasks
