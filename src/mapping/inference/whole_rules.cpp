// SPDX-License-Identifier: Apache-2.0
// Each rule is told once a change, however many commits evaluate it.
#include "mapping/inference/whole_rules.hpp"

#include <algorithm>

namespace cluxel::mapping {

void addWholeRules(const std::vector<WholeRule>& more, std::vector<WholeRule>& all, ProgressSink& sink) {
  for (const WholeRule& whole : more) {
    if (std::any_of(all.begin(), all.end(), [&](const WholeRule& known) { return known.rule == whole.rule; })) continue;
    sink.note(whole.rule + " is evaluated for the whole map at each change: " + whole.reason);
    all.push_back(whole);
  }
}

}  // namespace cluxel::mapping
