// SPDX-License-Identifier: Apache-2.0
// What commands check before they answer from a file: whether it is a map, and whether its build is finished.
#pragma once

#include <optional>

#include "app/command.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::app {

/// Adds --allow-unfinished.
void addAllowUnfinished(CLI::App& command, bool& is_allowed);

/// Warns on stderr when the build is unfinished, so that answers cover only the scans so far, unless that is allowed.
void noteUnfinished(const fs::path& map, bool is_finished, bool is_allowed, Session& session);

/// Reads a store that was filled without a build. Absent for a map, and for a store without quads, which is left when
/// the first build of a map was killed before its first commit.
std::optional<rdf::QuadReader> storeWithoutScans(const fs::path& file);

}  // namespace cluxel::app
