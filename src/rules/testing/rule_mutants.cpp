// SPDX-License-Identifier: Apache-2.0
// Walks all conditions of a rule in one order. A mutant finds its condition in the copy by its number in that order.
#include "rules/testing/rule_mutants.hpp"

namespace cluxel::rules {

namespace {

/// Calls see(condition, node) for the condition and its operands, outermost first. The operand of `unseen` is left out:
/// it repeats the test of the node behind it.
template <typename ConditionLike, typename See>
void forEachPart(ConditionLike& condition, std::optional<NodeIndex> node, const See& see) {
  see(condition, node);
  if (condition.kind == Condition::Kind::Unseen) return;
  for (auto& operand : condition.operands) forEachPart(operand, node, see);
}

template <typename RuleLike, typename See>
void forEachCondition(RuleLike& rule, const See& see) {
  for (auto& condition : rule.seed.where) forEachPart(condition, std::nullopt, see);
  if (rule.group)
    for (auto& condition : rule.group->limits) forEachPart(condition, std::nullopt, see);
  for (NodeIndex i = 0; i < rule.nodes.size(); ++i) {
    auto& what = rule.nodes[i].what;
    if (auto* branch = std::get_if<BranchNode>(&what)) forEachPart(branch->condition, i, see);
    if (auto* find = std::get_if<FindNode>(&what))
      for (auto& condition : find->where) forEachPart(condition, i, see);
    if (auto* accept = std::get_if<AcceptLeaf>(&what))
      for (auto& absorb : accept->absorb)
        for (auto& condition : absorb.when) forEachPart(condition, i, see);
  }
}

template <typename RuleLike, typename See>
void forEachEvidence(RuleLike& rule, const See& see) {
  for (auto& line : rule.evidence) see(line, std::optional<NodeIndex>());
  for (NodeIndex i = 0; i < rule.nodes.size(); ++i)
    if (auto* accept = std::get_if<AcceptLeaf>(&rule.nodes[i].what))
      for (auto& line : accept->evidence) see(line, std::optional(i));
}

class MutantMaker {
 public:
  explicit MutantMaker(const Rule& rule) : rule_(rule) {}

  std::vector<MutantOfRule> make() {
    std::size_t number = 0;
    forEachCondition(rule_, [&](const Condition& condition, std::optional<NodeIndex> node) {
      ofCondition(condition, node, number++);
    });
    number = 0;
    forEachEvidence(rule_,
                    [&](const EvidenceLine& line, std::optional<NodeIndex> node) { ofEvidence(line, node, number++); });
    for (NodeIndex i = 0; i < rule_.nodes.size(); ++i) ofNode(i);
    return std::move(mutants_);
  }

 private:
  void add(const SourceLocation& at, std::string what, std::optional<NodeIndex> node,
           std::function<void(Rule&)> apply) {
    mutants_.push_back({{rule_.id, at, std::move(what), ""}, node, std::move(apply)});
  }

  /// Changes the condition with this number in a copy.
  static std::function<void(Rule&)> inCopy(std::size_t number, std::function<void(Condition&)> change) {
    return [number, change = std::move(change)](Rule& copy) {
      std::size_t at = 0;
      forEachCondition(copy, [&](Condition& condition, std::optional<NodeIndex> /*node*/) {
        if (at++ == number) change(condition);
      });
    };
  }

  void ofCondition(const Condition& condition, std::optional<NodeIndex> node, std::size_t number) {
    using Kind = Condition::Kind;
    const std::string words = describe(condition);
    if ((condition.kind == Kind::All || condition.kind == Kind::Any) && condition.operands.size() > 1)
      add(condition.at, words + ": all and any exchanged", node,
          inCopy(number, [](Condition& c) { c.kind = c.kind == Kind::All ? Kind::Any : Kind::All; }));
    if (condition.kind != Kind::Attribute && condition.kind != Kind::Pair) return;
    add(condition.at, words + ": comparison reversed", node,
        inCopy(number, [](Condition& c) { c.comparison = negated(c.comparison); }));
    for (const double factor : {0.5, 2.0}) {
      const std::string done = factor < 1 ? "halved" : "doubled";
      if (condition.ratio_attribute) {
        add(condition.at, words + ": ratio " + done, node,
            inCopy(number, [factor](Condition& c) { c.ratio *= factor; }));
      } else if (condition.upper) {
        // A range is moved outwards at one end at a time: its other end stays.
        if (factor < 1 && condition.value->value > 0)
          add(condition.at, words + ": lower end halved", node,
              inCopy(number, [](Condition& c) { c.value->value *= 0.5; }));
        if (factor > 1)
          add(condition.at, words + ": upper end doubled", node,
              inCopy(number, [](Condition& c) { c.upper->value *= 2; }));
      } else if (condition.value && condition.value->value != 0) {
        add(condition.at, words + ": threshold " + done, node,
            inCopy(number, [factor](Condition& c) { c.value->value *= factor; }));
      }
    }
  }

  void ofEvidence(const EvidenceLine& line, std::optional<NodeIndex> node, std::size_t number) {
    add(line.at, describe(line) + ": without weight", node, [number](Rule& copy) {
      std::size_t at = 0;
      forEachEvidence(copy, [&](EvidenceLine& other, std::optional<NodeIndex> /*node*/) {
        if (at++ != number) return;
        other.weight = other.missing = 0;
        for (EvidenceLine::Knot& knot : other.knots) knot.log_odds = 0;
      });
    });
  }

  void ofNode(NodeIndex index) {
    const TreeNode& node = rule_.nodes[index];
    if (std::holds_alternative<BranchNode>(node.what))
      add(node.at, "yes and no exchanged", index, [index](Rule& copy) {
        auto& branch = std::get<BranchNode>(copy.nodes[index].what);
        std::swap(branch.yes, branch.no);
      });
    if (const auto* find = std::get_if<FindNode>(&node.what))
      add(node.at, "find " + find->name + ": never finds", index, [index](Rule& copy) {
        auto& other = std::get<FindNode>(copy.nodes[index].what);
        other.found = other.missing;
      });
  }

  const Rule& rule_;
  std::vector<MutantOfRule> mutants_;
};

}  // namespace

std::vector<MutantOfRule> mutantsOf(const Rule& rule) {
  return MutantMaker(rule).make();
}

}  // namespace cluxel::rules
