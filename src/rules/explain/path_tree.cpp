// SPDX-License-Identifier: Apache-2.0
// Reads the flat steps of a decision again along the conditions of its rule, in the order in which they were written.
#include "rules/explain/path_tree.hpp"

#include <algorithm>
#include <set>

namespace cluxel::rules {

namespace {

class PathTreeReader {
 public:
  PathTreeReader(const Rule& rule, const Decision& decision) : rule_(rule), decision_(decision) {}

  /// Empty when the steps are not those of a walk, as of a primitive that was gathered into an object.
  std::vector<WalkedPath> read() {
    std::vector<WalkedPath> walked;
    NodeIndex at = 0;
    while (is_walk_) {
      const TreeNode& node = rule_.nodes.at(at);
      if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
        walked.push_back({at, treeOf(branch->condition)});
        at = walked.back().tests.passed ? branch->yes : branch->no;
      } else if (const auto* find = std::get_if<FindNode>(&node.what)) {
        PathNode tests = stepNode("finds " + find->name + ":");
        tests.kind = PathNode::Kind::Find;
        walked.push_back({at, std::move(tests)});
        at = walked.back().tests.passed ? find->found : find->missing;
      } else {
        return walked;
      }
    }
    return {};
  }

 private:
  /// `test`: how the text of the step begins.
  PathNode stepNode(const std::string& test) {
    PathNode node;
    const std::vector<DecisionStep>& path = decision_.path;
    is_walk_ = is_walk_ && at_ < path.size() && path[at_].test.starts_with(test);
    if (!is_walk_) return node;
    node.step = at_;
    node.passed = decision_.path.at(at_++).passed;
    return node;
  }

  PathNode treeOf(const Condition& condition) {
    using Kind = Condition::Kind;
    if (condition.kind == Kind::All || condition.kind == Kind::Any) return joinedNode(condition);
    if (condition.kind != Kind::Not || condition.operands.front().operands.empty())
      return stepNode(describe(condition));
    PathNode node;
    node.kind = PathNode::Kind::Not;
    node.operands = {treeOf(condition.operands.front())};
    node.passed = !node.operands.front().passed;
    return node;
  }

  PathNode joinedNode(const Condition& condition) {
    const bool all = condition.kind == Condition::Kind::All;
    PathNode node;
    node.kind = all ? PathNode::Kind::All : PathNode::Kind::Any;
    node.passed = all;
    for (const Condition& operand : condition.operands) {
      // A query whose answer could not change the outcome was not asked.
      if (operand.kind == Condition::Kind::Ask && node.passed != all) {
        node.operands.push_back({PathNode::Kind::Skipped, false, std::nullopt, {}});
        continue;
      }
      node.operands.push_back(treeOf(operand));
      const bool passed = node.operands.back().passed;
      node.passed = all ? node.passed && passed : node.passed || passed;
    }
    return node;
  }

  const Rule& rule_;
  const Decision& decision_;
  std::size_t at_ = 0;
  bool is_walk_ = true;
};

std::string dotText(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '"' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe;
}

/// One line for each operand of a joined condition.
std::string labelOf(const TreeNode& node) {
  if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
    const Condition& condition = branch->condition;
    const bool joined = condition.kind == Condition::Kind::All || condition.kind == Condition::Kind::Any;
    if (!joined) return dotText(describe(condition));
    std::string text = condition.kind == Condition::Kind::All ? "all:" : "any:";
    for (const Condition& operand : condition.operands) text += "\\l" + dotText(describe(operand));
    return text + "\\l";
  }
  if (const auto* find = std::get_if<FindNode>(&node.what)) return "find " + dotText(find->name);
  if (const auto* reject = std::get_if<RejectLeaf>(&node.what)) return "reject: " + dotText(reject->reason);
  return "accept";
}

std::string edgeText(NodeIndex from, NodeIndex to, const char* label, const std::set<NodeIndex>& walked) {
  const bool bold = walked.contains(from) && walked.contains(to);
  return "  n" + std::to_string(from) + " -> n" + std::to_string(to) + " [label=\"" + label + "\"" +
         (bold ? ", style=bold" : ", color=gray60") + "];\n";
}

}  // namespace

std::vector<WalkedPath> walkedPath(const Rule& rule, const Decision& decision) {
  return PathTreeReader(rule, decision).read();
}

std::string dotOf(const Rule& rule, const Decision& decision) {
  std::set<NodeIndex> walked{decision.leaf};
  for (const WalkedPath& step : walkedPath(rule, decision)) walked.insert(step.node);
  std::string text = "digraph \"" + dotText(rule.id) + "\" {\n  node [shape=box];\n";
  for (NodeIndex i = 0; i < rule.nodes.size(); ++i) {
    const TreeNode& node = rule.nodes[i];
    const bool is_leaf = std::holds_alternative<AcceptLeaf>(node.what) || std::holds_alternative<RejectLeaf>(node.what);
    text += "  n" + std::to_string(i) + " [label=\"" + labelOf(node) + "\"" + (is_leaf ? ", shape=ellipse" : "") +
            (walked.contains(i) ? ", style=bold" : ", color=gray60") + "];\n";
    if (const auto* branch = std::get_if<BranchNode>(&node.what))
      text += edgeText(i, branch->yes, "yes", walked) + edgeText(i, branch->no, "no", walked);
    if (const auto* find = std::get_if<FindNode>(&node.what))
      text += edgeText(i, find->found, "found", walked) + edgeText(i, find->missing, "missing", walked);
  }
  return text + "}\n";
}

}  // namespace cluxel::rules
