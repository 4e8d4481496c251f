// SPDX-License-Identifier: Apache-2.0
// What a map file says about itself: whether its build is finished, and of which inputs it is made.
#pragma once

#include <optional>
#include <string>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/map_inputs.hpp"

namespace cluxel {

struct MapState {
  bool is_finished = false;
  std::string inputs_hash;  ///< hex of MapInputs::hash()
  bool operator==(const MapState&) const = default;
};

void storeState(WriteTransaction& transaction, const MapState& state);
/// Absent in a file whose first commit has not happened.
std::optional<MapState> storedState(const ReadTransaction& transaction);

void storeInputs(WriteTransaction& transaction, const MapInputs& inputs);
MapInputs storedInputs(const ReadTransaction& transaction);

}  // namespace cluxel
