// SPDX-License-Identifier: Apache-2.0
// What commands check before they answer from a file: whether it is a map, and whether its build is finished.
#pragma once

#include <optional>

#include "app/command.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::app {

/// Adds --allow-unfinished.
void addAllowUnfinished(CLI::App& command, bool& is_allowed);

/// Notes on stderr that the answers are those of the scans so far, unless that is allowed.
void noteUnfinished(const fs::path& map, bool is_finished, bool is_allowed, Session& session);

/// The quads of a store that no build has made; absent for a map, and for a store without quads (its first build never
/// committed).
std::optional<rdf::QuadReader> storeWithoutScans(const fs::path& file);

}  // namespace cluxel::app
