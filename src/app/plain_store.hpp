// SPDX-License-Identifier: Apache-2.0
// Stores that hold quads but no scans: `load` and Redland make them.
#pragma once

#include <filesystem>
#include <optional>

#include "rdf/store/quad_store.hpp"

namespace cluxel::app {

/// The quads of a store that no build has made; absent for a map, and for a store without quads (its first build never
/// committed).
std::optional<rdf::QuadReader> storeWithoutScans(const std::filesystem::path& file);

}  // namespace cluxel::app
