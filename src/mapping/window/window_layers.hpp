// SPDX-License-Identifier: Apache-2.0
// Writes what was decided in a window into the layers of its tiles and the records of its objects.
#pragma once

#include "mapping/window/window_decision.hpp"

namespace cluxel::mapping {

/// Undecided primitives keep their objects and traces.
void writeLayers(rdf::WriteTransaction& transaction, const DecidedWindow& decided, const OutputChanges& changes);

}  // namespace cluxel::mapping
