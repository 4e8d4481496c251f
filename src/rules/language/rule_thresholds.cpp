// SPDX-License-Identifier: Apache-2.0
// Walks a rule set once, and hashes all that a run reads of it but the numbered thresholds.
#include "rules/language/rule_thresholds.hpp"

#include <cstring>
#include <initializer_list>
#include <span>
#include <utility>

namespace cluxel::rules {

namespace {

constexpr std::uint32_t kNumbering = 2;  ///< changes with what is numbered

std::uint64_t startOf(const ContentHash& whole) {
  std::uint64_t start = 0;
  std::memcpy(&start, whole.bytes.data(), sizeof(start));
  return start;
}

bool isOrdered(Comparison comparison) {
  return comparison != Comparison::Equal && comparison != Comparison::NotEqual;
}

/// Whether the distance found does not follow from the threshold, which only says how far is looked.
bool isPlainDistance(const Condition& condition) {
  const double farthest_m = std::max(condition.value->value, condition.upper ? condition.upper->value : 0);
  const bool is_bound = condition.target->kind == Target::Kind::Name;
  switch (condition.measure) {
    case PairMeasure::AdjacentFraction:
      return true;
    case PairMeasure::AxisDistance:
    case PairMeasure::VerticalGap:
      return is_bound;
    default:
      break;
  }
  // Which object passes a test of being far away follows from how far is looked.
  const bool is_near = condition.comparison == Comparison::Less || condition.comparison == Comparison::LessEqual ||
                       condition.comparison == Comparison::Between;
  return farthest_m + kMeasureMargin_m < kMaxMeasure_m && (is_near || condition.target->kind != Target::Kind::Object);
}

class ThresholdNumbering {
 public:
  explicit ThresholdNumbering(RuleSet& rules) : rules_(rules) {}

  void run() {
    hash_.add(kNumbering);
    for (const auto& [name, iri] : rules_.prefixes) hash_.addText(name).addText(iri);
    addTexts(rules_.order);
    hash_.add(rules_.strata.size());
    for (const std::vector<std::string>& stratum : rules_.strata) addTexts(stratum);
    for (const double log_odds : rules_.nothing) hash_.add(log_odds);
    hash_.add(rules_.asks_map).add(rules_.rules.size());
    for (Rule& rule : rules_.rules) add(rule);
    rules_.thresholds = std::move(thresholds_);
    rules_.constants = std::move(constants_);
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
    const bool is_plain = hasPlainThreshold(condition);
    hash_.add(is_plain);
    condition.threshold = condition.upper_threshold = 0;
    if (is_plain) {
      number(condition);
    } else {
      add(condition.value), add(condition.upper);
      hash_.add(condition.ratio);
    }
    hash_.addText(condition.ratio_of).add(condition.ratio_attribute.has_value());
    if (condition.ratio_attribute) hash_.add(*condition.ratio_attribute);
    add(condition.ratio_slice);
    add(condition.labels);
    hash_.addText(condition.class_iri).addText(condition.query).add(condition.asks_rivals);
    addTexts(condition.query_names);
    add(condition.operands);
  }
  void number(Condition& condition) {
    const bool is_range = condition.upper.has_value();
    const bool is_met_by_equal = condition.ratio_attribute || is_range ||
                                 condition.comparison == Comparison::GreaterEqual ||
                                 condition.comparison == Comparison::Less;
    condition.threshold =
        number({condition.ratio_attribute ? condition.ratio : condition.value->value, is_met_by_equal});
    if (is_range) condition.upper_threshold = number({condition.upper->value, false});
  }
  void number(const std::optional<double>& distance_m, std::uint32_t& threshold) {
    hash_.add(distance_m.has_value());
    threshold = distance_m ? number({*distance_m, false}) : 0;
  }
  std::uint32_t number(const PlainThreshold& threshold) {
    thresholds_.push_back(threshold);
    return static_cast<std::uint32_t>(thresholds_.size());
  }

  void add(std::vector<Condition>& conditions) {
    hash_.add(conditions.size());
    for (Condition& condition : conditions) add(condition);
  }

  void add(std::vector<EvidenceLine>& lines) {
    hash_.add(lines.size());
    for (EvidenceLine& line : lines) {
      hash_.add(line.kind).add(line.asks_rivals).add(line.knots.size());
      add(line.measure);
      line.constant = numberConstant({line.missing});
      for (const EvidenceLine::Knot& knot : line.knots) numberConstant({knot.at, knot.log_odds});
      if (line.kind != EvidenceLine::Kind::Curve) numberConstant({line.about, line.spread, line.weight});
    }
  }

  std::uint32_t numberConstant(ContentHasher constant) {
    constants_.push_back(startOf(constant.finish()));
    return static_cast<std::uint32_t>(constants_.size());
  }
  std::uint32_t numberConstant(std::initializer_list<double> values) {
    ContentHasher hasher;
    for (const double value : values) hasher.add(value);
    return numberConstant(std::move(hasher));
  }

  void add(Rule& rule) {
    hash_.addText(rule.id).addText(rule.class_iri).add(rule.leftovers).addText(rule.seed.name);
    add(rule.seed.labels);
    add(rule.seed.slice);
    add(rule.seed.where);
    hash_.add(rule.group.has_value());
    if (rule.group) {
      add(rule.group->labels);
      GroupSpec& group = *rule.group;
      number(group.near_m, group.near_threshold);
      number(group.horizontal_m, group.horizontal_threshold);
      number(group.vertical_m, group.vertical_threshold);
      hash_.add(group.adjacent);
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
    hash_.add(accept.merge_into).add(accept.confidence.ramps.size());
    // The surest leaf of all tells about the class-wide object.
    if (accept.merge_into == MergeInto::Class) hash_.add(accept.confidence.low).add(accept.confidence.high);
    ContentHasher confidence;
    confidence.add(accept.confidence.low).add(accept.confidence.high);
    for (const ConfidenceRamp& ramp : accept.confidence.ramps) {
      hash_.addText(ramp.of).add(ramp.attribute);
      confidence.add(ramp.at_low).add(ramp.at_high);
    }
    accept.constant = numberConstant(std::move(confidence));
    add(accept.evidence);
    hash_.add(accept.absorb.size());
    for (AbsorbSpec& absorb : accept.absorb) {
      add(absorb.labels);
      add(absorb.when);
      hash_.addText(absorb.into).add(absorb.late);
      absorb.threshold = number({absorb.max_fraction_of_points, true});
    }
    hash_.add(accept.splitting.has_value());
    if (accept.splitting) add(*accept.splitting);
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
  std::vector<std::uint64_t> constants_;
};

}  // namespace

bool hasPlainThreshold(const Condition& condition) {
  using Kind = Condition::Kind;
  if (!isOrdered(condition.comparison)) return false;
  if (condition.kind == Kind::Attribute)
    return condition.ratio_attribute ? !condition.upper : condition.value.has_value();
  if (!condition.value) return false;
  return condition.kind == Kind::Label || condition.kind == Kind::Relation ||
         (condition.kind == Kind::Pair && isPlainDistance(condition));
}

void numberThresholds(RuleSet& rules) {
  ThresholdNumbering(rules).run();
}

}  // namespace cluxel::rules
