// SPDX-License-Identifier: Apache-2.0
// Commands that answer from a map say when its build is unfinished.
#pragma once

#include "app/command.hpp"

namespace cluxel::app {

/// Adds --allow-unfinished.
void addAllowUnfinished(CLI::App& command, bool& is_allowed);

/// Notes on stderr that the answers are those of the scans so far, unless that is allowed.
void noteUnfinished(const fs::path& map, bool is_finished, bool is_allowed, Session& session);

}  // namespace cluxel::app
