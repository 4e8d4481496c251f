// SPDX-License-Identifier: Apache-2.0
// Walks through all conditions of a rule set and adds up how far they look.
#include "rules/decide/local_reach.hpp"

#include <algorithm>
#include <cmath>

#include "rules/propose/evidence.hpp"
#include "rules/propose/fragment_search.hpp"
#include "rules/propose/pair_measures.hpp"
#include "rules/propose/unseen_ends.hpp"

namespace cluxel::rules {

namespace {

class Reaching {
 public:
  explicit Reaching(const RuleSet& rules) : rules_(rules) {}

  LocalReach run() {
    if (rules_.asks_map) refuse("the rules ask the map");
    for (const Rule& rule : rules_.rules) {
      rule_ = &rule;
      lookAtSeeds();
      for (const EvidenceLine& line : rule.evidence) reach(reachOf(line));
      for (const TreeNode& node : rule.nodes) lookAt(node);
    }
    if (!obstacle_.empty()) return {std::nullopt, obstacle_};
    return {reach_m_, {}};
  }

  /// Whether the rule decides about each fragment alone and makes no object but that of its class.
  bool isOfLoneSeeds(const Rule& rule) {
    rule_ = &rule;
    obstacle_.clear();
    double around = 0;
    for (const Condition& condition : rule.seed.where) around = std::max(around, reachOf(condition));
    for (const EvidenceLine& line : rule.evidence) around = std::max(around, reachOf(line));
    for (const TreeNode& node : rule.nodes) {
      if (std::holds_alternative<FindNode>(node.what)) return false;
      if (const auto* branch = std::get_if<BranchNode>(&node.what))
        around = std::max(around, reachOf(branch->condition));
      const auto* accept = std::get_if<AcceptLeaf>(&node.what);
      if (accept == nullptr) continue;
      if (accept->merge_into != MergeInto::Class) return false;
      lookAt(*accept);
      for (const EvidenceLine& line : accept->evidence) around = std::max(around, reachOf(line));
    }
    return around == 0 && obstacle_.empty() && !rule.group && !rule.seed.slice;
  }

 private:
  void reach(double distance_m) { reach_m_ = std::max(reach_m_, distance_m); }
  void refuse(const std::string& why) {
    if (obstacle_.empty()) obstacle_ = rule_ == nullptr ? why : "rule '" + rule_->id + "' " + why;
  }

  void lookAtSeeds() {
    for (const Condition& condition : rule_->seed.where) reach(reachOf(condition));
    if (!rule_->group) return;
    reach(searchedAround(std::max(rule_->group->near_m.value_or(0), rule_->group->horizontal_m.value_or(0))));
    for (const Condition& limit : rule_->group->limits) reach(reachOf(limit));
  }

  void lookAt(const TreeNode& node) {
    if (const auto* branch = std::get_if<BranchNode>(&node.what)) reach(reachOf(branch->condition));
    if (const auto* find = std::get_if<FindNode>(&node.what)) reach(reachOfSearch(find->where, find->name));
    if (const auto* accept = std::get_if<AcceptLeaf>(&node.what)) lookAt(*accept);
  }

  void lookAt(const AcceptLeaf& accept) {
    for (const EvidenceLine& line : accept.evidence) reach(reachOf(line));
    for (const AbsorbSpec& spec : accept.absorb) reach(reachOfSearch(spec.when, "it"));
    if (accept.splitting && accept.splitting->gather) reach(accept.splitting->gather->within_m);
    if (accept.merge_into == MergeInto::Class) checkWholeClass(accept);
    if (accept.merge_into == MergeInto::Related) checkRelated();
  }

  /// Of the candidates that are looked up near a bound name, each may look around itself.
  double reachOfSearch(const std::vector<Condition>& conditions, const std::string& name) {
    const auto tie =
        std::find_if(conditions.begin(), conditions.end(), [&](const Condition& c) { return looksNearby(c, name); });
    if (tie == conditions.end()) return 0;  // finds nothing
    double around = 0;
    for (const Condition& condition : conditions) around = std::max(around, reachOf(condition));
    if (tie->kind == Condition::Kind::Relation || tie->measure == PairMeasure::AdjacentFraction)
      return rules_.contact_m + around;
    if (tie->measure == PairMeasure::VerticalGap || tie->measure == PairMeasure::AxisDistance)
      refuse("looks things up by a distance without a bound in plan view");
    return searchedAround(tie->upper ? tie->upper->value : tie->value->value) + around;
  }

  /// How far a condition looks from what is bound.
  double reachOf(const Condition& condition) {
    using Kind = Condition::Kind;
    switch (condition.kind) {
      case Kind::Attribute:
      case Kind::Label:
      case Kind::Class:
        return 0;
      case Kind::Ask:
        refuse("asks the map");
        return 0;
      case Kind::Relation:
        return rules_.contact_m;
      case Kind::Pair: {
        const double limit = condition.value ? condition.value->value : 0;
        return reachOfPair(condition, std::max(limit, condition.upper ? condition.upper->value : 0));
      }
      default:
        break;
    }
    double around = condition.kind == Kind::Unseen ? kHiding_m + kBeyond_m : 0;
    for (const Condition& operand : condition.operands) around = std::max(around, reachOf(operand));
    return around;
  }

  double reachOfPair(const Condition& condition, double limit_m) {
    if (condition.measure == PairMeasure::AdjacentFraction) return rules_.contact_m;
    if (condition.target->kind == Target::Kind::Name) return 0;  // both are bound
    if (condition.measure == PairMeasure::VerticalGap || condition.measure == PairMeasure::AxisDistance)
      refuse("measures a distance without a bound in plan view");
    return std::min(limit_m, kMaxMeasure_m) + kMeasureMargin_m;
  }

  double reachOf(const EvidenceLine& line) {
    if (line.kind == EvidenceLine::Kind::Test) return reachOf(line.measure);
    return line.measure.kind == Condition::Kind::Pair ? reachOfPair(line.measure, rules::reachOf(line))
                                                      : reachOf(line.measure);
  }

  /// A class-wide object must consist of seeds alone, and be the only one of its class.
  void checkWholeClass(const AcceptLeaf& accept) {
    if (!accept.absorb.empty() || accept.splitting) refuse("lets the object of a whole class grow");
    if (accept.parts.size() != 1 || accept.parts.front().first != rule_->seed.name)
      refuse("gives the object of a whole class more than its seeds");
    for (const Rule& other : rules_.rules)
      for (const TreeNode& node : other.nodes)
        if (const auto* leaf = std::get_if<AcceptLeaf>(&node.what);
            leaf != nullptr && other.class_iri == rule_->class_iri && leaf->merge_into == MergeInto::Nothing)
          refuse("joins the objects of a class, of which another rule makes more");
  }

  /// What is far away is nobody's relative.
  void checkRelated() {
    for (const TreeNode& node : rule_->nodes)
      if (const auto* branch = std::get_if<BranchNode>(&node.what);
          branch != nullptr && mayRelateFar(branch->condition))
        refuse("joins an object that may be far away");
  }
  static bool mayRelateFar(const Condition& condition) {
    if (condition.kind == Condition::Kind::Pair && condition.target && condition.target->kind == Target::Kind::Object) {
      const bool is_share = condition.measure == PairMeasure::AdjacentFraction;
      using enum Comparison;
      const Comparison comparison = condition.comparison;
      return is_share ? comparison != Greater && comparison != GreaterEqual
                      : comparison != Less && comparison != LessEqual && comparison != Between;
    }
    return std::any_of(condition.operands.begin(), condition.operands.end(), mayRelateFar);
  }

  const RuleSet& rules_;
  const Rule* rule_ = nullptr;
  double reach_m_ = rules_.contact_m;
  std::string obstacle_;
};

}  // namespace

LocalReach localReach(const RuleSet& rules) {
  return Reaching(rules).run();
}

std::size_t strataOfLoneSeeds(const RuleSet& rules) {
  Reaching reaching(rules);
  const auto isOfLoneSeeds = [&](const std::vector<std::string>& stratum) {
    return stratum.size() == 1 && std::all_of(rules.rules.begin(), rules.rules.end(), [&](const Rule& rule) {
             return rule.class_iri != stratum.front() || reaching.isOfLoneSeeds(rule);
           });
  };
  std::size_t count = 0;
  while (count < rules.strata.size() && isOfLoneSeeds(rules.strata[count])) ++count;
  return count;
}

DividedStrata dividedStrata(const RuleSet& rules) {
  const std::span<const std::vector<std::string>> all(rules.strata);
  const std::size_t lone = strataOfLoneSeeds(rules);
  return {all.first(lone), all.subspan(lone)};
}

}  // namespace cluxel::rules
