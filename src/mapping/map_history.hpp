// SPDX-License-Identifier: Apache-2.0
// The history graph: who ran what when, and from which files. Not part of the map function.
#pragma once

#include <vector>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/cloud.hpp"
#include "cluxel/mapping/map_inputs.hpp"

namespace cluxel {

/// Adds one activity that used `clouds` and `inputs`; `started_s` and `ended_s` in seconds since 1970.
void addBuildActivity(WriteTransaction& transaction, const std::vector<Cloud>& clouds, const MapInputs& inputs,
                      double started_s, double ended_s);

}  // namespace cluxel
