// SPDX-License-Identifier: Apache-2.0
// Changes of an operator's statements by SPARQL Update, and all inference from them, in one commit.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "cluxel/progress.hpp"
#include "mapping/change/map_editor.hpp"
#include "mapping/window/semantic_update.hpp"
#include "rdf/ontology/ontology.hpp"
#include "sparql/update_engine.hpp"

namespace cluxel::mapping {

/// How a map follows an update.
struct MapUpdateParams {
  std::string author = {};           ///< who makes and withdraws statements, for the history
  std::string operation = "update";  ///< the command, for the history
  UpdateParams layers = {};          ///< how objects are decided again
  bool dry_run = false;              ///< compute what would change, and write nothing
};

struct MapUpdateReport : sparql::UpdateReport {
  bool is_map = false;  ///< else a store that no build has made
  ChangeReport change;  ///< of a map: what became of its objects
};

/// As rdf::writeMap(). A dry run of a map that this process may not write gets a temporary copy, and that is noted.
rdf::WriteTransaction writeOrCopy(const std::filesystem::path& file, bool is_dry_run, ProgressSink& sink);

/// Runs a SPARQL Update on a map or another quad file. In a map, what follows is inferred, SPARQL rules included, and
/// the objects around new and withdrawn statements are decided again; when its rules use `ask:`, all objects are,
/// because answers may have changed. Commits everything or nothing. Throws as runUpdate(); Error (InvalidArgument) when
/// a build of the map is unfinished, when it is of another version and would be decided anew, or when all graphs of a
/// map are to be writable. Deadline and budget of memory cover what is inferred, the queries of SPARQL rules included.
MapUpdateReport updateMap(const std::filesystem::path& file, const std::string& update,
                          const sparql::UpdateOptions& options, ProgressSink& sink, const MapUpdateParams& params = {});

/// Computes again what follows from the operator's statements of a map. `before`: quadsThatNameResources() before the
/// update; those that the update added are anchored. Throws Error (InvalidArgument), naming `file`, when objects of a
/// map of another version would be decided anew.
ChangeReport inferAfterUpdate(rdf::WriteTransaction& transaction, const std::filesystem::path& file,
                              const std::set<rdf::QuadIds>& before, ProgressSink& sink,
                              const rdf::InferenceCheck& check = {}, const MapUpdateParams& params = {});

}  // namespace cluxel::mapping
