// SPDX-License-Identifier: Apache-2.0
// SPARQL rules that cost a whole evaluation when the map changes.
#pragma once

#include <string>
#include <vector>

#include "cluxel/progress.hpp"

namespace cluxel::mapping {

/// A rule whose solutions cannot be evaluated for what a change affects alone.
struct WholeRule {
  std::string rule;    ///< name of its file
  std::string reason;  ///< "it aggregates over the map"
  bool operator==(const WholeRule&) const = default;
};

/// Adds those that `all` does not name yet; each that it adds is noted.
void addWholeRules(const std::vector<WholeRule>& more, std::vector<WholeRule>& all, ProgressSink& sink);

}  // namespace cluxel::mapping
