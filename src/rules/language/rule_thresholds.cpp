// SPDX-License-Identifier: Apache-2.0
// Walks a rule set once, and hashes all that a run reads of it but the numbered thresholds.
#include "rules/language/rule_thresholds.hpp"

#include <span>

namespace cluxel::rules {

namespace {

class ThresholdNumbering {
 public:
  explicit ThresholdNumbering(RuleSet& rules) : rules_(rules) {}

  void run() {
    for (const auto& [name, iri] : rules_.prefixes) hash_.addText(name).addText(iri);
    addTexts(rules_.order);
    hash_.add(rules_.strata.size());
    for (const std::vector<std::string>& stratum : rules_.strata) addTexts(stratum);
    for (const double log_odds : rules_.nothing) hash_.add(log_odds);
    hash_.add(rules_.asks_map).add(rules_.rules.size());
    for (Rule& rule : rules_.rules) add(rule);
    rules_.thresholds = std::move(thresholds_);
    rules_.structure = hash_.finish();
  }

 private:
  void addTexts(const std::vector<std::string>& texts) {
    hash_.add(texts.size());
    for (const std::string& text : texts) hash_.addText(text);
  }
  void add(const std::vector<scan::PrimitiveLabel>& labels) { hash_.addSpan(std::span(labels)); }
  void add(const std::optional<double>& value) { hash_.add(value.has_value()).add(value.value_or(0)); }
  void add(const std::optional<SliceSpec>& slice) {
    hash_.add(slice.has_value());
    if (slice) hash_.add(slice->from_m).add(slice->to_m);
  }
  void add(const std::optional<Target>& target) {
    hash_.add(target.has_value());
    if (!target) return;
    hash_.add(target->kind).addText(target->name).addText(target->object_class);
    add(target->labels);
  }
  void add(const std::optional<Quantity>& quantity) { add(quantity ? std::optional(quantity->value) : std::nullopt); }

  void add(Condition& condition) {
    hash_.add(condition.kind).addText(condition.of).add(condition.attribute);
    add(condition.slice);
    hash_.add(condition.measure).add(condition.relation);
    add(condition.target);
    hash_.add(condition.comparison);
    condition.threshold = 0;
    if (hasPlainThreshold(condition)) {
      const bool is_met_by_equal =
          condition.comparison == Comparison::GreaterEqual || condition.comparison == Comparison::Less;
      thresholds_.push_back({condition.value->value, is_met_by_equal});
      condition.threshold = static_cast<std::uint32_t>(thresholds_.size());
    } else {
      add(condition.value);
    }
    add(condition.upper);
    hash_.add(condition.ratio).addText(condition.ratio_of).add(condition.ratio_attribute.has_value());
    if (condition.ratio_attribute) hash_.add(*condition.ratio_attribute);
    add(condition.ratio_slice);
    add(condition.labels);
    hash_.addText(condition.class_iri).addText(condition.query).add(condition.asks_rivals);
    addTexts(condition.query_names);
    add(condition.operands);
  }
  void add(std::vector<Condition>& conditions) {
    hash_.add(conditions.size());
    for (Condition& condition : conditions) add(condition);
  }

  void add(std::vector<EvidenceLine>& lines) {
    hash_.add(lines.size());
    for (EvidenceLine& line : lines) {
      hash_.add(line.kind).add(line.knots.size());
      for (const EvidenceLine::Knot& knot : line.knots) hash_.add(knot.at).add(knot.log_odds);
      hash_.add(line.about).add(line.spread).add(line.weight).add(line.missing).add(line.asks_rivals);
      add(line.measure);
    }
  }

  void add(Rule& rule) {
    hash_.addText(rule.id).addText(rule.class_iri).add(rule.leftovers).addText(rule.seed.name);
    add(rule.seed.labels);
    add(rule.seed.slice);
    add(rule.seed.where);
    hash_.add(rule.group.has_value());
    if (rule.group) {
      add(rule.group->labels);
      for (const auto& distance : {rule.group->near_m, rule.group->horizontal_m, rule.group->vertical_m}) add(distance);
      hash_.add(rule.group->adjacent);
      add(rule.group->limits);
    }
    add(rule.evidence);
    hash_.add(rule.nodes.size());
    for (TreeNode& node : rule.nodes) {
      hash_.add(node.what.index());
      std::visit([this](auto& what) { add(what); }, node.what);
    }
  }

  void add(BranchNode& branch) {
    add(branch.condition);
    hash_.add(branch.yes).add(branch.no);
  }
  void add(FindNode& find) {
    hash_.addText(find.name).addText(find.object_class).addText(find.nearest_to);
    add(find.labels);
    add(find.where);
    hash_.add(find.choose).add(find.share).add(find.found).add(find.missing);
  }
  void add(RejectLeaf& reject) { hash_.addText(reject.reason).addText(reject.hint).add(reject.leave_unknown); }
  void add(AcceptLeaf& accept) {
    hash_.add(accept.parts.size());
    for (const auto& [name, part_class] : accept.parts) hash_.addText(name).addText(part_class);
    hash_.add(accept.confidence.low).add(accept.confidence.high).add(accept.confidence.ramps.size());
    for (const ConfidenceRamp& ramp : accept.confidence.ramps)
      hash_.addText(ramp.of).add(ramp.attribute).add(ramp.at_low).add(ramp.at_high);
    add(accept.evidence);
    hash_.add(accept.absorb.size());
    for (AbsorbSpec& absorb : accept.absorb) {
      add(absorb.labels);
      add(absorb.when);
      hash_.add(absorb.max_fraction_of_points).addText(absorb.into).add(absorb.late);
    }
    hash_.add(accept.splitting.has_value());
    if (accept.splitting) add(*accept.splitting);
    hash_.add(accept.merge_into);
  }
  void add(const SplittingSpec& split) {
    hash_.addText(split.part).addText(split.from);
    for (const double distance_m : {split.reach_m, split.jump_m, split.start_m, split.clearance_m})
      hash_.add(distance_m);
    hash_.add(split.gather.has_value());
    if (split.gather) hash_.add(split.gather->within_m).add(split.gather->above_m);
  }

  RuleSet& rules_;
  ContentHasher hash_;
  std::vector<PlainThreshold> thresholds_;
};

}  // namespace

bool hasPlainThreshold(const Condition& condition) {
  switch (condition.comparison) {
    case Comparison::Less:
    case Comparison::LessEqual:
    case Comparison::Greater:
    case Comparison::GreaterEqual:
      break;
    default:
      return false;
  }
  return condition.value && ((condition.kind == Condition::Kind::Attribute && !condition.ratio_attribute) ||
                             condition.kind == Condition::Kind::Label);
}

void numberThresholds(RuleSet& rules) {
  ThresholdNumbering(rules).run();
}

}  // namespace cluxel::rules
