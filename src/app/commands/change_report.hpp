// SPDX-License-Identifier: Apache-2.0
// How the commands that change a map report what changed.
#pragma once

#include "app/command.hpp"
#include "mapping/change/map_editor.hpp"

namespace cluxel::app {

/// Adds --dry-run and --batch-points. `params` must outlive the command.
void addChangeOptions(CLI::App& command, mapping::ChangeParams& params, bool in_batches);

/// Prints scans, tiles and objects that changed: as text, or as JSON.
void printChange(const fs::path& map, const mapping::ChangeReport& report, const mapping::ChangeParams& params,
                 const Session& session);

}  // namespace cluxel::app
