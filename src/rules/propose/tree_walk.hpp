// SPDX-License-Identifier: Apache-2.0
// Evaluates the decision tree of one rule for one candidate and records the path.
#pragma once

#include <optional>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// A branch or find on the path, with the first of its tests in WalkResult::path.
struct WalkedNode {
  NodeIndex node = 0;
  std::size_t first_step = 0;
};

struct WalkResult {
  NodeIndex leaf = 0;
  Bindings bindings;  ///< the seed and what was found
  std::vector<DecisionStep> path;
  std::vector<WalkedNode> walked;
  std::optional<OwnerIndex> related;  ///< for merge_into: related
};

/// Evaluates the tree for `seed`, with the values of `changed`, if any, instead of the measured ones.
WalkResult walkTree(const ReasoningState& state, const Rule& rule, const Candidate& seed,
                    const ChangedValues* changed = nullptr);

}  // namespace cluxel::rules
