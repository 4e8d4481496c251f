// SPDX-License-Identifier: Apache-2.0
// The mutants of one rule.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "rules/testing/rule_mutation.hpp"

namespace cluxel::rules {

struct MutantOfRule {
  RuleMutant mutant;
  std::optional<NodeIndex> node;     ///< only decisions that passed this node can differ
  std::function<void(Rule&)> apply;  ///< to a copy of the rule
};

std::vector<MutantOfRule> mutantsOf(const Rule& rule);

}  // namespace cluxel::rules
