// SPDX-License-Identifier: Apache-2.0
// The history graph: who ran what when, and from which files. Not part of the map function.
#pragma once

#include <vector>

#include "mapping/cloud.hpp"
#include "mapping/map_inputs.hpp"
#include "rdf/store/environment.hpp"

namespace cluxel::mapping {

/// Adds one activity that used `clouds` and `inputs`; `started_s` and `ended_s` in seconds since 1970.
void addBuildActivity(rdf::WriteTransaction& transaction, const std::vector<Cloud>& clouds, const MapInputs& inputs,
                      double started_s, double ended_s);

}  // namespace cluxel::mapping
