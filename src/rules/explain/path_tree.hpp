// SPDX-License-Identifier: Apache-2.0
// The path of a decision with the structure of its tests: which belong to one `all` or `any`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rules/language/rule_set.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::rules {

/// A test on the path, or several that are joined.
struct PathNode {
  enum class Kind : std::uint8_t { All, Any, Not, Test, Find, Skipped } kind = Kind::Test;
  bool passed = false;
  std::optional<std::size_t> step;  ///< of a test or find: its number in Decision::path
  std::vector<PathNode> operands;
};

/// A node of the rule's tree that was walked.
struct WalkedPath {
  NodeIndex node = 0;
  PathNode tests;
};

/// The nodes of the tree from its root to the leaf, read from the steps alone. Empty when the steps are not those of a
/// walk through the tree, as of a primitive that was gathered into an object.
std::vector<WalkedPath> walkedPath(const Rule& rule, const Decision& decision);

/// The rule's tree as a Graphviz graph. What the decision went through is drawn bold.
std::string dotOf(const Rule& rule, const Decision& decision);

}  // namespace cluxel::rules
