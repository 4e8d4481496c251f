// SPDX-License-Identifier: Apache-2.0
// Walks one thing through one rule's tree, and keeps the way it took.
#pragma once

#include <optional>
#include <vector>

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// One branch or find on the way, with its tests' place in the path.
struct WalkedNode {
  NodeIndex node = 0;
  std::size_t first_step = 0, step_count = 0;
};

struct WalkResult {
  NodeIndex leaf = 0;
  Bindings bindings;  ///< the seed and what was found
  std::vector<DecisionStep> path;
  std::vector<WalkedNode> walked;
  std::optional<OwnerIndex> related;  ///< for merge_into: related
};

/// Walks `seed` through the tree. The branch `flipped`, if any, takes its other way (a find: its missing one).
WalkResult walkTree(const ReasoningState& state, const Rule& rule, const Thing& seed,
                    std::optional<NodeIndex> flipped = std::nullopt);

}  // namespace cluxel
