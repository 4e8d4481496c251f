// SPDX-License-Identifier: Apache-2.0
// Follows a decision tree from the root to a leaf: branches test, finds bind names.
#include "rules/propose/tree_walk.hpp"

#include <algorithm>

#include "rdf/iri.hpp"
#include "rules/propose/condition_eval.hpp"
#include "rules/propose/fragment_search.hpp"

namespace cluxel::rules {

namespace {

std::string describeFind(const FindNode& find) {
  std::string text = "finds " + find.name + ":";
  for (std::size_t i = 0; i < find.labels.size(); ++i)
    text += (i == 0 ? " " : " or ") + std::string(nameOf(find.labels[i]));
  if (!find.object_class.empty()) text += " of " + withArticle(rdf::localName(find.object_class));
  for (const Condition& condition : find.where) text += ", " + describe(condition);
  return text;
}

class Walk {
 public:
  Walk(const ReasoningState& state, const Rule& rule, const ChangedValues* changed) : state_(state), rule_(rule) {
    result_.bindings.changed = changed;
  }

  WalkResult from(const Candidate& seed) {
    result_.bindings.candidates.emplace_back(rule_.seed.name, seed);
    NodeIndex at = 0;
    while (true) {
      const TreeNode& node = rule_.nodes[at];
      if (const auto* branch = std::get_if<BranchNode>(&node.what))
        at = takeBranch(at, *branch);
      else if (const auto* find = std::get_if<FindNode>(&node.what))
        at = takeFind(at, *find);
      else
        break;
    }
    result_.leaf = at;
    return std::move(result_);
  }

 private:
  NodeIndex takeBranch(NodeIndex at, const BranchNode& branch) {
    result_.walked.push_back({at, result_.path.size()});
    ConditionEvaluator evaluator(state_, rule_, result_.bindings);
    const bool passed = evaluator.holds(branch.condition, &result_.path);
    if (passed && evaluator.related()) result_.related = evaluator.related();
    return passed ? branch.yes : branch.no;
  }

  /// A find binds free fragments, fragments shared by this class, or (for reference) those of an object; never one that
  /// is already bound.
  bool mayBind(const FindNode& find, FragmentIndex fragment) const {
    const OwnerIndex owner = state_.fragments[fragment].owner;
    if (!find.object_class.empty()) {
      if (owner >= state_.objects.size() || !state_.belongsTo(fragment, find.object_class)) return false;
    } else if (owner != kFree && !(find.share && owner == kShared)) {
      return false;
    }
    const scan::PrimitiveLabel label = state_.fragments.labelOf(fragment);
    const bool labelled =
        find.labels.empty() || std::find(find.labels.begin(), find.labels.end(), label) != find.labels.end();
    return labelled && !result_.bindings.holds(fragment);
  }

  NodeIndex takeFind(NodeIndex at, const FindNode& find) {
    const auto passing = findPassing(state_, rule_, find.where, find.name, result_.bindings,
                                     [&](FragmentIndex fragment) { return mayBind(find, fragment); });
    DecisionStep step;
    if (state_.context.keeps_paths) {
      step.rule_id = rule_.id;
      step.test = describeFind(find);
      step.file = rule_.nodes[at].at.file;
    }
    step.line = rule_.nodes[at].at.line;
    step.measured = static_cast<double>(passing.size());
    step.passed = !passing.empty();
    result_.walked.push_back({at, result_.path.size()});
    result_.path.push_back(std::move(step));
    if (passing.empty()) return find.missing;
    const Candidate* nearest_to = find.nearest_to.empty() ? nullptr : &result_.bindings.at(find.nearest_to);
    Candidate candidate = state_.fragments.candidateOf(choose(state_, find.choose, passing, nearest_to));
    result_.bindings.candidates.emplace_back(find.name, std::move(candidate));
    return find.found;
  }

  const ReasoningState& state_;
  const Rule& rule_;
  WalkResult result_;
};

}  // namespace

WalkResult walkTree(const ReasoningState& state, const Rule& rule, const Candidate& seed,
                    const ChangedValues* changed) {
  return Walk(state, rule, changed).from(seed);
}

}  // namespace cluxel::rules
