// SPDX-License-Identifier: Apache-2.0
// Texts are found by the address of what they describe.
#include "rules/propose/rule_texts.hpp"

#include <variant>

namespace cluxel::rules {

RuleTexts::RuleTexts(const RuleSet& rules) {
  for (const Rule& rule : rules.rules) {
    for (const Condition& condition : rule.seed.where) add(condition);
    add(rule.evidence);
    for (const TreeNode& node : rule.nodes) {
      if (const auto* branch = std::get_if<BranchNode>(&node.what)) add(branch->condition);
      if (const auto* accept = std::get_if<AcceptLeaf>(&node.what)) add(accept->evidence);
    }
  }
}

void RuleTexts::add(const Condition& condition) {
  texts_.emplace(&condition, describe(condition));
  for (const Condition& operand : condition.operands) add(operand);
}

void RuleTexts::add(const std::vector<EvidenceLine>& lines) {
  for (const EvidenceLine& line : lines) texts_.emplace(&line, describe(line));
}

}  // namespace cluxel::rules
