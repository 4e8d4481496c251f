// SPDX-License-Identifier: Apache-2.0
// Reads the state that a build leaves in a map.
#include "app/map_condition.hpp"

#include "mapping/map_state.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::app {

void addAllowUnfinished(CLI::App& command, bool& is_allowed) {
  command.add_flag("--allow-unfinished", is_allowed, "do not warn when the build of the map is unfinished");
}

void noteUnfinished(const fs::path& map, bool is_finished, bool is_allowed, Session& session) {
  if (is_finished || is_allowed) return;
  session.console.note(map.string() +
                       ": warning: the build of this map is unfinished, so the answers are those of some of its scans; "
                       "repeat the command build to finish it, or write --allow-unfinished");
}

std::optional<rdf::QuadReader> storeWithoutScans(const fs::path& file) {
  const rdf::ReadTransaction transaction = rdf::Environment::open(file, rdf::OpenMode::ReadOnly)->read();
  if (mapping::storedState(transaction)) return std::nullopt;
  rdf::QuadReader quads(transaction);
  if (quads.size() == 0) return std::nullopt;
  return quads;
}

}  // namespace cluxel::app
