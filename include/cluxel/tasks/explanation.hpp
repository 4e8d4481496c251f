// SPDX-License-Identifier: Apache-2.0
// Why something in a map is what it is.
#pragma once

#include <string>

#include "cluxel/mapping/map_reader.hpp"

namespace cluxel {

/// Explains an object or a primitive, named by its IRI (also in <> or as map:…), by "object/…" or "primitive/…", or by
/// the first digits of its hash. Runs the map's own rules again on its scene. Throws Error (NoRows) when nothing or
/// more than one thing has the name. `as_json`: JSON text instead of prose.
std::string explainThing(const MapReader& map, const std::string& name, bool as_json);

}  // namespace cluxel
