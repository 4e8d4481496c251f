// SPDX-License-Identifier: Apache-2.0
// An operator's statements: changed by SPARQL Update, and what follows from them inferred in the same commit.
#pragma once

#include <filesystem>
#include <string>

#include "cluxel/base/progress.hpp"
#include "cluxel/sparql/update_engine.hpp"

namespace cluxel {

/// Runs a SPARQL Update on a map or another quad file. In a map, graph `inferred` becomes what follows from all graphs,
/// SPARQL rules included; when its rules `ask:`, the objects are computed anew too, because the answers may have
/// changed. All of it or nothing. Errors as runUpdate(); Error (Usage) when a build of the map is unfinished.
UpdateReport updateMap(const std::filesystem::path& file, const std::string& update, const UpdateOptions& options,
                       ProgressSink& sink);

}  // namespace cluxel
