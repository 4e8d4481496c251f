// SPDX-License-Identifier: Apache-2.0
// Finds unreachable branches: interval analysis of the attribute tests on the path to a node.
#include "rules/language/path_knowledge.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

class ReachabilityCheck {
 public:
  ReachabilityCheck(const Rule& rule, FaultList& faults) : rule_(rule), faults_(faults) {}

  void visit(NodeIndex index, const PathKnowledge& knowledge) {
    const TreeNode& node = rule_.nodes[index];
    if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
      follow(branch->yes, branch->condition, true, knowledge);
      follow(branch->no, branch->condition, false, knowledge);
    } else if (const auto* find = std::get_if<FindNode>(&node.what)) {
      visitFind(node, *find, knowledge);
    }
  }

 private:
  void follow(NodeIndex below, const Condition& condition, bool truth, PathKnowledge knowledge) {
    if (below == 0) return;
    if (const auto why = knowledge.learn(condition, truth))
      return faults_.error(rule_.nodes[below].at, "nothing can get here: " + *why,
                           "the test stands in line " + std::to_string(condition.at.line));
    visit(below, knowledge);
  }

  void visitFind(const TreeNode& node, const FindNode& find, const PathKnowledge& knowledge) {
    PathKnowledge inside = knowledge;
    inside.setLabels(find.name, find.labels);
    for (const Condition& condition : find.where)
      if (find.choose != Choice::All)
        if (const auto why = inside.learn(condition, true)) {
          faults_.error(node.at, "nothing can be found: " + *why,
                        "the test stands in line " + std::to_string(condition.at.line));
          if (find.missing != 0) visit(find.missing, knowledge);
          return;
        }
    if (find.found != 0) visit(find.found, inside);
    if (find.missing != 0) visit(find.missing, knowledge);
  }

  const Rule& rule_;
  FaultList& faults_;
};

}  // namespace

void checkReachability(const Rule& rule, FaultList& faults) {
  if (rule.nodes.empty()) return;
  PathKnowledge knowledge;
  if (!rule.group) {
    knowledge.setLabels(rule.seed.name, rule.seed.labels);
    // A slice is measured on its own: tests of the whole seed imply nothing about it.
    if (!rule.seed.slice)
      for (const Condition& condition : rule.seed.where)
        if (const auto why = knowledge.learn(condition, true))
          return faults.error(condition.at, "no seed can pass: " + *why);
  }
  ReachabilityCheck(rule, faults).visit(0, knowledge);
}

}  // namespace cluxel::rules
