// SPDX-License-Identifier: Apache-2.0
// The state of a map file: whether its build is finished, and the inputs it was built from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mapping/map_inputs.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

struct MapState {
  bool is_finished = false;
  std::string inputs_hash;  ///< hex of MapInputs::hash()
  bool operator==(const MapState&) const = default;
};

void storeState(rdf::WriteTransaction& transaction, const MapState& state);
/// Absent before the first commit of a build.
std::optional<MapState> storedState(const rdf::ReadTransaction& transaction);

/// Whether what it holds is that of some of its scans. False for a store that no build has made.
bool hasUnfinishedBuild(const rdf::ReadTransaction& transaction);

/// True for a map, false for a store that no build has made. Throws Error (InvalidArgument) when a build is unfinished.
bool requireFinished(const std::filesystem::path& file, const rdf::ReadTransaction& transaction);

void storeInputs(rdf::WriteTransaction& transaction, const MapInputs& inputs);
MapInputs storedInputs(const rdf::ReadTransaction& transaction);
/// The inputs of a map that can be changed. Throws Error, naming `file`: StoreUnavailable for a store that no build has
/// made, InvalidArgument for an unfinished map, and for one of another version of the stages.
MapInputs requireFinishedInputs(const rdf::ReadTransaction& transaction, const std::filesystem::path& file);
/// Throws Error (InvalidArgument): the map's stored outputs do not fit this program.
[[noreturn]] void refuseOtherVersion(const std::filesystem::path& file);

}  // namespace cluxel::mapping
