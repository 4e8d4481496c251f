// SPDX-License-Identifier: Apache-2.0
// Joins what two paths to accept leaves imply, solves it for a box, and lets both rules judge the box.
#include "rules/testing/rule_pairs.hpp"

#include <algorithm>
#include <cstdio>

#include "base/yaml/fault_list.hpp"
#include "rules/decide/reason.hpp"
#include "rules/propose/evidence.hpp"
#include "rules/testing/pair_witness.hpp"

namespace cluxel::rules {

namespace {

constexpr const char* kThing = "thing";  // the seed, under one name for all rules
constexpr double kLeastChance = 0.05;    // of a candidate without rivals

/// A test on a path with its result.
struct PathFact {
  Condition condition;
  bool truth = true;
};

/// A way from the root of a rule to an accept leaf.
struct AcceptPath {
  const AcceptLeaf* leaf = nullptr;
  std::vector<PathFact> facts;  ///< about the seed alone
  bool looks_around = false;    ///< it depends on other things, too
  bool needs_other = false;     ///< it needs another thing
};

/// The condition about the seed under its common name; none when it is about anything else.
std::optional<Condition> aboutThing(Condition condition, const std::string& seed) {
  using Kind = Condition::Kind;
  const bool is_joined = condition.kind == Kind::All || condition.kind == Kind::Any || condition.kind == Kind::Not;
  if (!is_joined && condition.kind != Kind::Attribute && condition.kind != Kind::Label) return std::nullopt;
  if (!is_joined && condition.of != seed) return std::nullopt;
  condition.of = kThing;
  if (condition.ratio_of == seed) condition.ratio_of = kThing;
  for (Condition& operand : condition.operands) {
    std::optional<Condition> renamed = aboutThing(operand, seed);
    if (!renamed) return std::nullopt;
    operand = std::move(*renamed);
  }
  return condition;
}

class PathGathering {
 public:
  explicit PathGathering(const Rule& rule) : rule_(rule) {}

  std::vector<AcceptPath> gather() {
    AcceptPath start;
    for (const Condition& condition : rule_.seed.where) add(start, condition, true);
    if (!rule_.nodes.empty()) visit(0, start);
    return std::move(paths_);
  }

 private:
  void add(AcceptPath& path, const Condition& condition, bool truth) const {
    if (condition.kind == Condition::Kind::All && truth) {
      for (const Condition& operand : condition.operands) add(path, operand, true);
    } else if (auto about = aboutThing(condition, rule_.seed.name)) {
      path.facts.push_back({std::move(*about), truth});
    } else {
      path.looks_around = true;
    }
  }

  void visit(NodeIndex index, const AcceptPath& path) {
    const TreeNode& node = rule_.nodes[index];
    if (const auto* accept = std::get_if<AcceptLeaf>(&node.what)) {
      paths_.push_back(path);
      paths_.back().leaf = accept;
    } else if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
      for (const bool truth : {true, false}) {
        AcceptPath next = path;
        add(next, branch->condition, truth);
        visit(truth ? branch->yes : branch->no, next);
      }
    } else if (const auto* find = std::get_if<FindNode>(&node.what)) {
      AcceptPath next = path;
      next.looks_around = true;
      visit(find->missing, next);
      next.needs_other = true;
      visit(find->found, next);
    }
  }

  const Rule& rule_;
  std::vector<AcceptPath> paths_;
};

bool isSameLine(const EvidenceLine& a, const EvidenceLine& b) {
  return a.kind == b.kind && describe(a) == describe(b) && a.about == b.about && a.spread == b.spread &&
         a.weight == b.weight && a.missing == b.missing &&
         std::equal(a.knots.begin(), a.knots.end(), b.knots.begin(), b.knots.end(),
                    [](const auto& x, const auto& y) { return x.at == y.at && x.log_odds == y.log_odds; });
}

/// What one rule knows of its own, and its place in the order.
class JudgedRule {
 public:
  JudgedRule(const RuleSet& rules, const Rule& rule) : rule(rule), paths(PathGathering(rule).gather()), alone_(rules) {
    alone_.rules = {rule};
    for (std::size_t i = 0; i < rules.strata.size(); ++i)
      if (std::find(rules.strata[i].begin(), rules.strata[i].end(), rule.class_iri) != rules.strata[i].end()) {
        has_rivals = rules.strata[i].size() > 1 && !rule.leftovers;
        turn = 2 * i + (rules.strata[i].size() > 1 && rule.leftovers ? 1 : 0);
      }
  }

  /// The confidence of the object that the rule makes of the scene when there are no other rules.
  std::optional<double> confidenceOf(const perception::Scene& scene) const {
    const ReasoningResult result = reason(scene, alone_);
    if (result.objects.empty()) return std::nullopt;
    return result.objects.front().confidence;
  }

  std::vector<EvidenceLine> evidenceOf(const AcceptPath& path) const {
    std::vector<EvidenceLine> lines = rule.evidence;
    lines.insert(lines.end(), path.leaf->evidence.begin(), path.leaf->evidence.end());
    return lines;
  }

  const Rule& rule;
  std::vector<AcceptPath> paths;
  std::size_t turn = 0;     ///< in the order of strata and their leftovers
  bool has_rivals = false;  ///< it competes with rules of other classes

 private:
  RuleSet alone_;
};

std::optional<std::string> learnPath(PathKnowledge& knowledge, const AcceptPath& path) {
  for (const PathFact& fact : path.facts)
    if (auto contradiction = knowledge.learn(fact.condition, fact.truth)) return contradiction;
  return std::nullopt;
}

class PairCheck {
 public:
  explicit PairCheck(const RuleSet& rules) : rules_(rules) {
    for (const RuleSource& source : rules.sources) faults_.addFile(source.name, source.text);
    for (const Rule& rule : rules.rules)
      if (!rule.seed.slice && !asks(rule)) judged_.emplace_back(rules, rule);
  }

  std::vector<Diagnostic> run() {
    for (const JudgedRule& a : judged_)
      for (const JudgedRule& b : judged_) {
        const bool is_before = a.rule.at.line < b.rule.at.line || a.rule.at.file != b.rule.at.file;
        if (a.has_rivals && b.has_rivals && a.turn == b.turn && a.rule.class_iri != b.rule.class_iri && is_before)
          reportUndecided(a, b);
        if (a.turn < b.turn) reportShadow(a, b);
      }
    return faults_.sorted();
  }

 private:
  static bool asksIn(const Condition& condition) {
    return condition.kind == Condition::Kind::Ask ||
           std::any_of(condition.operands.begin(), condition.operands.end(), asksIn);
  }
  static bool asksInAny(const std::vector<Condition>& conditions) {
    return std::any_of(conditions.begin(), conditions.end(), asksIn);
  }
  static bool asksInLines(const std::vector<EvidenceLine>& lines) {
    return std::any_of(lines.begin(), lines.end(), [](const EvidenceLine& line) { return asksIn(line.measure); });
  }
  static bool asks(const Rule& rule) {
    if (asksInAny(rule.seed.where) || asksInLines(rule.evidence)) return true;
    return std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const TreeNode& node) {
      if (const auto* branch = std::get_if<BranchNode>(&node.what)) return asksIn(branch->condition);
      if (const auto* find = std::get_if<FindNode>(&node.what)) return asksInAny(find->where);
      const auto* accept = std::get_if<AcceptLeaf>(&node.what);
      if (accept == nullptr) return false;
      return asksInLines(accept->evidence) ||
             std::any_of(accept->absorb.begin(), accept->absorb.end(),
                         [](const AbsorbSpec& absorb) { return asksInAny(absorb.when); });
    });
  }

  /// A thing of which both rules make an object.
  struct Witness {
    BoxPrimitive box;
    double first = 0, second = 0;  ///< confidences
  };
  static std::optional<Witness> witnessOf(const PathKnowledge& knowledge, const JudgedRule& a, const JudgedRule& b) {
    Witness witness;
    const auto accepts = [&](const perception::Scene& scene) {
      const std::optional<double> first = a.confidenceOf(scene);
      const std::optional<double> second = first ? b.confidenceOf(scene) : std::nullopt;
      witness.first = first.value_or(0);
      witness.second = second.value_or(0);
      return second.has_value();
    };
    auto box = boxWithin(knowledge, kThing, accepts);
    if (!box) return std::nullopt;
    witness.box = std::move(*box);
    return witness;
  }

  /// What both paths imply; absent when no thing can follow both.
  static std::optional<PathKnowledge> knowledgeOf(const JudgedRule& a, const AcceptPath& first, const JudgedRule& b,
                                                  const AcceptPath& second) {
    std::vector<scan::PrimitiveLabel> labels;
    for (const scan::PrimitiveLabel label : a.rule.seed.labels)
      if (std::find(b.rule.seed.labels.begin(), b.rule.seed.labels.end(), label) != b.rule.seed.labels.end())
        labels.push_back(label);
    PathKnowledge knowledge;
    knowledge.setLabels(kThing, labels);
    if (labels.empty() || learnPath(knowledge, first) || learnPath(knowledge, second)) return std::nullopt;
    return knowledge;
  }

  void reportUndecided(const JudgedRule& a, const JudgedRule& b) {
    for (const AcceptPath& first : a.paths)
      for (const AcceptPath& second : b.paths) {
        if (first.needs_other || second.needs_other) continue;
        const std::vector<EvidenceLine> lines = a.evidenceOf(first), others = b.evidenceOf(second);
        if (!std::equal(lines.begin(), lines.end(), others.begin(), others.end(), isSameLine)) continue;
        const auto knowledge = knowledgeOf(a, first, b, second);
        const auto witness = knowledge ? witnessOf(*knowledge, a, b) : std::nullopt;
        if (!witness) continue;
        char odds[64];
        std::snprintf(odds, sizeof odds, "%.2f and %.2f", witness->first, witness->second);
        return faults_.warning(b.rule.at,
                               "'" + a.rule.id + "' and '" + b.rule.id +
                                   "' can both take one thing, and no evidence decides between them: confidences " +
                                   odds,
                               "both accept " + primitivesText(witness->box));
      }
  }

  /// Every thing that follows the path `second` also follows the path `first`.
  static bool covers(const JudgedRule& a, const AcceptPath& first, const JudgedRule& b, const AcceptPath& second) {
    if (first.looks_around || first.leaf->merge_into == MergeInto::Related) return false;
    PathKnowledge knowledge;
    knowledge.setLabels(kThing, b.rule.seed.labels);
    if (learnPath(knowledge, second)) return true;  // no thing follows it
    const std::vector<scan::PrimitiveLabel> left = knowledge.labelsOf(kThing);
    const auto& labels = a.rule.seed.labels;
    return std::all_of(left.begin(), left.end(),
                       [&](auto label) { return std::find(labels.begin(), labels.end(), label) != labels.end(); }) &&
           std::all_of(first.facts.begin(), first.facts.end(),
                       [&](const PathFact& fact) { return knowledge.implies(fact.condition, fact.truth); });
  }

  /// True when the candidates of the path become objects wherever nothing else wants their parts.
  bool isAlwaysLikely(const JudgedRule& a, const AcceptPath& path) const {
    if (!a.evidenceOf(path).empty()) return false;
    const double least = std::min(path.leaf->confidence.low, path.leaf->confidence.high);
    if (!a.has_rivals) return least >= kLeastChance;
    return std::all_of(a.rule.seed.labels.begin(), a.rule.seed.labels.end(), [&](scan::PrimitiveLabel label) {
      return logOdds(least) > rules_.nothing[static_cast<std::size_t>(label)];
    });
  }

  void reportShadow(const JudgedRule& a, const JudgedRule& b) {
    if (b.paths.empty()) return;
    const AcceptPath* by = nullptr;
    for (const AcceptPath& second : b.paths) {
      const auto cover = std::find_if(a.paths.begin(), a.paths.end(), [&](const AcceptPath& first) {
        return isAlwaysLikely(a, first) && covers(a, first, b, second);
      });
      if (cover == a.paths.end()) return;
      by = &*cover;
    }
    for (const AcceptPath& second : b.paths) {
      if (second.needs_other) continue;
      const auto knowledge = knowledgeOf(a, *by, b, second);
      const auto witness = knowledge ? witnessOf(*knowledge, a, b) : std::nullopt;
      if (!witness) continue;
      return faults_.warning(
          b.rule.at,
          "'" + b.rule.id + "' takes nothing that '" + a.rule.id + "' does not take before it, by each primitive alone",
          "both accept " + primitivesText(witness->box));
    }
  }

  const RuleSet& rules_;
  FaultList faults_;
  std::vector<JudgedRule> judged_;
};

}  // namespace

std::vector<Diagnostic> checkRulePairs(const RuleSet& rules) {
  return PairCheck(rules).run();
}

}  // namespace cluxel::rules
