// SPDX-License-Identifier: Apache-2.0
// The note about unfinished maps.
#include "app/unfinished_note.hpp"

namespace cluxel::app {

void addAllowUnfinished(CLI::App& command, bool& is_allowed) {
  command.add_flag("--allow-unfinished", is_allowed, "no note when the build of the map is unfinished");
}

void noteUnfinished(const fs::path& map, bool is_finished, bool is_allowed, Session& session) {
  if (is_finished || is_allowed) return;
  session.console.note(map.string() +
                       ": warning: the build of this map is unfinished, so the answers are those of some of its scans; "
                       "repeat the command build to finish it, or write --allow-unfinished");
}

}  // namespace cluxel::app
