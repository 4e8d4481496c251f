// SPDX-License-Identifier: Apache-2.0
// How the commands that change a map report what changed.
#pragma once

#include "app/command.hpp"
#include "mapping/change/map_editor.hpp"

namespace cluxel::app {

/// Adds --dry-run and --batch-points. `params` must outlive the command.
void addChangeOptions(CLI::App& command, mapping::ChangeParams& params, bool in_batches);

/// Adds --list.
void addListed(CLI::App& command, std::size_t& listed);

/// Adds --dry-run.
void addDryRun(CLI::App& command, bool& is_dry_run);

/// What printChange() prints as JSON.
Json changeJson(const fs::path& map, const mapping::ChangeReport& report, bool dry_run);

/// Prints scans, tiles and objects that changed: as text, which names up to `listed` objects of each kind, or as JSON.
void printChange(const fs::path& map, const mapping::ChangeReport& report, const mapping::ChangeParams& params,
                 const Session& session, std::size_t listed = 0);

}  // namespace cluxel::app
