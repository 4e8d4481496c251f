// SPDX-License-Identifier: Apache-2.0
// One small function per kind of condition.
#include "rules/propose/condition_eval.hpp"

#include <algorithm>
#include <cmath>

#include "rdf/map_iris.hpp"
#include "rules/explain/changed_values.hpp"
#include "rules/propose/pair_measures.hpp"
#include "rules/propose/unseen_ends.hpp"

namespace cluxel::rules {

namespace {

constexpr double kGroundTolerance_m = 0.30;  // the tolerance of touches_ground in relationInfos()

std::string_view stepUnit(const Condition& condition) {
  if (condition.kind == Condition::Kind::Attribute) {
    const perception::Dimension dimension =
        perception::attributeInfos()[static_cast<std::size_t>(condition.attribute)].dimension;
    return dimension == perception::Dimension::Angle ? "rad" : unitOf(dimension);
  }
  return condition.kind == Condition::Kind::Pair && condition.measure == PairMeasure::AdjacentFraction ? "" : "m";
}

/// For an interval, the bound nearer to the value: the one a small change would cross.
double nearerThreshold(const Condition& condition, double value, double threshold) {
  const bool upper = condition.upper && std::abs(value - condition.upper->value) < std::abs(value - threshold);
  return upper ? condition.upper->value : threshold;
}

}  // namespace

bool compare(const Condition& condition, double value, double threshold) {
  switch (condition.comparison) {
    case Comparison::Less:
      return value < threshold;
    case Comparison::LessEqual:
      return value <= threshold;
    case Comparison::Greater:
      return value > threshold;
    case Comparison::GreaterEqual:
      return value >= threshold;
    case Comparison::Equal:
      return value == threshold;
    case Comparison::NotEqual:
      return value != threshold;
    case Comparison::Between:
      return value >= threshold && value <= condition.upper->value;
    case Comparison::Outside:
      break;
  }
  return value < threshold || value > condition.upper->value;
}

bool ConditionEvaluator::holds(const Condition& condition, std::vector<DecisionStep>* steps) {
  ++depth_;
  const bool passed = outcomeOf(condition, steps);
  if (--depth_ == 0) notes_.finish();
  return passed;
}

bool ConditionEvaluator::outcomeOf(const Condition& condition, std::vector<DecisionStep>* steps) {
  using Kind = Condition::Kind;
  if (condition.kind == Kind::All || condition.kind == Kind::Any) {
    const bool all = condition.kind == Kind::All;
    bool outcome = all;
    Witness witness(notes_);
    for (const Condition& operand : condition.operands) {
      // Queries are expensive: skip one whose answer cannot change the outcome.
      if (operand.kind == Kind::Ask && outcome != all) continue;
      const bool passed = outcomeOf(operand, steps);
      witness.take(passed != all);
      outcome = all ? outcome && passed : outcome || passed;
      if (steps == nullptr && outcome != all && witness.isSure()) break;
    }
    return outcome;
  }
  if (condition.kind == Kind::Not && !condition.operands.front().operands.empty())
    return !outcomeOf(condition.operands.front(), steps);
  DecisionStep step;
  const bool negative = condition.kind == Kind::Not;
  const bool passed = holdsElementary(negative ? condition.operands.front() : condition, step) != negative;
  if (steps == nullptr) return passed;
  if (state_.context.keeps_paths) {
    step.rule_id = rule_.id;
    step.test = state_.texts->of(condition);
    step.file = condition.at.file;
  }
  step.line = condition.at.line;
  step.passed = passed;
  steps->push_back(std::move(step));
  return passed;
}

bool ConditionEvaluator::allHold(const std::vector<Condition>& conditions) {
  // Stored attributes are tested first, because measuring costs time; the outcome is the same.
  const auto isCheap = [](const Condition& c) {
    return c.kind == Condition::Kind::Attribute && !c.slice && !c.ratio_slice;
  };
  ++depth_;
  Witness witness(notes_);
  bool passed = true;
  for (const bool cheap : {true, false})
    for (const Condition& condition : conditions) {
      if (!passed && (!cheap || witness.isSure())) break;
      if (isCheap(condition) != cheap) continue;
      const bool holds_it = outcomeOf(condition, nullptr);
      witness.take(!holds_it);
      passed = passed && holds_it;
    }
  if (--depth_ == 0) notes_.finish();
  return passed;
}

bool ConditionEvaluator::holdsElementary(const Condition& condition, DecisionStep& step) {
  using Kind = Condition::Kind;
  if (condition.kind == Kind::Unseen) return isUnseen(condition, step);
  const Candidate& subject = bindings_.at(condition.of);
  switch (condition.kind) {
    case Kind::Attribute:
      return holdsAttribute(condition, step);
    case Kind::Pair:
      return holdsPair(condition, step);
    case Kind::Relation:
      return holdsRelation(condition, step);
    case Kind::Ask:
      return holdsAsk(condition);
    case Kind::Label:
      if (condition.value) return holdsLabelShare(condition, step);
      return std::all_of(subject.fragments.begin(), subject.fragments.end(), [&](FragmentIndex fragment) {
        return std::find(condition.labels.begin(), condition.labels.end(), state_.fragments.labelOf(fragment)) !=
               condition.labels.end();
      });
    case Kind::Class:
      return std::any_of(subject.fragments.begin(), subject.fragments.end(),
                         [&](FragmentIndex fragment) { return state_.belongsTo(fragment, condition.class_iri); });
    default:
      return outcomeOf(condition, nullptr);
  }
}

bool ConditionEvaluator::holdsAttribute(const Condition& condition, DecisionStep& step) {
  const auto value = measured(condition.of, condition.slice, condition.attribute);
  std::optional<double> threshold;
  if (!condition.ratio_attribute)
    threshold = condition.value->value;
  else if (const auto other = measured(condition.ratio_of, condition.ratio_slice, *condition.ratio_attribute))
    step.other = other, threshold = condition.ratio * *other;
  step.measured = value;
  step.unit = stepUnit(condition);
  if (!value || !threshold) return false;  // the slice is empty
  if (step.other)
    notes_.addRatio(condition, bindings_.at(condition.of), *value, *step.other);
  else
    notes_.add(condition, bindings_.at(condition.of), *value);
  step.threshold = nearerThreshold(condition, *value, *threshold);
  return compare(condition, *value, *threshold);
}

bool ConditionEvaluator::isUnseen(const Condition& condition, DecisionStep& step) {
  const Condition& test = condition.operands.front();
  if (test.kind == Condition::Kind::Attribute) {
    holdsAttribute(test, step);
    step.threshold.reset();  // no other measured value would show the end
  }
  return truthOf(state_, bindings_, *this, test) == Truth::Unseen;
}

bool ConditionEvaluator::holdsLabelShare(const Condition& condition, DecisionStep& step) {
  double labelled = 0, all = 0;
  for (FragmentIndex fragment : bindings_.at(condition.of).fragments) {
    const double points = state_.fragments.shapeOf(fragment).points;
    const auto& labels = condition.labels;
    all += points;
    if (std::find(labels.begin(), labels.end(), state_.fragments.labelOf(fragment)) != labels.end()) labelled += points;
  }
  step.measured = orChanged(condition, all > 0 ? labelled / all : 0);
  notes_.add(condition, bindings_.at(condition.of), *step.measured);
  step.threshold = nearerThreshold(condition, *step.measured, condition.value->value);
  return compare(condition, *step.measured, condition.value->value);
}

std::optional<double> ConditionEvaluator::measured(const std::string& of, const std::optional<SliceSpec>& slice,
                                                   perception::Attribute attribute) const {
  const Candidate& candidate = bindings_.at(of);
  if (bindings_.changed != nullptr)
    if (const auto changed = bindings_.changed->of(candidate, slice, attribute)) return changed;
  if (!slice) return candidate.shape[attribute];
  const std::optional<Shape> shape = state_.fragments.shapeOfSlice(candidate, *slice);
  return shape ? std::optional((*shape)[attribute]) : std::nullopt;
}

double ConditionEvaluator::orChanged(const Condition& condition, double value) const {
  if (bindings_.changed == nullptr) return value;
  return bindings_.changed->of(condition, bindings_).value_or(value);
}

std::optional<double> ConditionEvaluator::measure(const Condition& condition, double reach) {
  if (condition.kind == Condition::Kind::Attribute) {
    const auto value = measured(condition.of, condition.slice, condition.attribute);
    if (!value || !condition.ratio_attribute) return value;
    const auto other = measured(condition.ratio_of, condition.ratio_slice, *condition.ratio_attribute);
    return other && *other > 0 ? std::optional(*value / *other) : std::nullopt;
  }
  const bool share = condition.measure == PairMeasure::AdjacentFraction;
  const double limit = share ? 0.5 : std::min(reach, kMaxMeasure_m - kMeasureMargin_m) + kMeasureMargin_m;
  const double none = share ? 0 : reach;
  if (condition.asks_rivals) return gapToRivals(condition, limit).value_or(none);
  double value = none;
  if (condition.target->kind == Target::Kind::Name)
    value =
        measurePair(state_, condition.measure, bindings_.at(condition.of), bindings_.at(condition.target->name), limit);
  else if (const auto nearest = nearestTarget(condition, limit, false))
    value = nearest->second;
  value = orChanged(condition, value);
  return std::isfinite(value) ? value : none;
}

std::string ConditionEvaluator::unitOf(const Condition& condition) {
  return condition.ratio_attribute ? "" : std::string(stepUnit(condition));
}

bool ConditionEvaluator::holdsPair(const Condition& condition, DecisionStep& step) {
  const double threshold = condition.value->value;
  const bool share = condition.measure == PairMeasure::AdjacentFraction;
  double measured = share ? 0 : std::numeric_limits<double>::infinity();
  const double limit =
      share ? 0.5 : std::max(threshold, condition.upper ? condition.upper->value : 0) + kMeasureMargin_m;
  if (condition.asks_rivals) {
    measured = gapToRivals(condition, limit).value_or(measured);
  } else if (condition.target->kind == Target::Kind::Name) {
    measured =
        measurePair(state_, condition.measure, bindings_.at(condition.of), bindings_.at(condition.target->name), limit);
  } else if (const auto nearest = nearestTarget(condition, limit, compare(condition, measured, threshold))) {
    measured = orChanged(condition, nearest->second);
    if (compare(condition, measured, threshold)) remember(nearest->first, *condition.target);
  }
  if (std::isfinite(measured)) measured = orChanged(condition, measured);
  step.is_looked_for = condition.measure == PairMeasure::Gap || condition.measure == PairMeasure::HorizontalGap;
  if (std::isfinite(measured)) step.measured = measured;
  notes_.add(condition, bindings_.at(condition.of), step.is_looked_for ? std::min(measured, limit) : measured);
  step.threshold = nearerThreshold(condition, measured, threshold);
  step.unit = stepUnit(condition);
  return compare(condition, measured, threshold);
}

bool ConditionEvaluator::holdsRelation(const Condition& condition, DecisionStep& step) {
  const Candidate& subject = bindings_.at(condition.of);
  if (condition.value) step.threshold = condition.value->value, step.unit = "m";
  if (condition.relation == perception::RelationKind::TouchesGround) {
    step.measured = measured(condition.of, std::nullopt, perception::Attribute::Bottom);
    step.threshold = condition.value ? condition.value->value : kGroundTolerance_m;
    step.unit = "m";
    notes_.add(condition, subject, *step.measured);
    return *step.measured <= *step.threshold;
  }
  std::optional<std::pair<FragmentIndex, double>> best;
  if (condition.target->kind == Target::Kind::Name) {
    const auto measure = relationMeasure(state_, condition.relation, subject, bindings_.at(condition.target->name));
    if (measure) best = {subject.fragments.front(), *measure};
  } else {
    for (const auto& [fragment, measure] : relatedFragments(state_, condition.relation, subject)) {
      if (!fits(fragment, *condition.target)) continue;
      const bool better = !best || measure < best->second ||
                          (measure == best->second && state_.fragments.before(fragment, best->first));
      if (better) best = {fragment, measure};
    }
  }
  if (!best) return false;
  step.measured = orChanged(condition, best->second);
  notes_.add(condition, subject, *step.measured);
  const bool passed = !condition.value || *step.measured <= condition.value->value;
  if (passed && condition.target->kind != Target::Kind::Name) remember(best->first, *condition.target);
  return passed;
}

bool ConditionEvaluator::holdsAsk(const Condition& condition) {
  if (state_.context.oracle == nullptr)
    throw Error(ErrorKind::FaultyInput, toString(condition.at) + ": rule '" + rule_.id +
                                            "' asks the map, but there is no map to ask here; build or open one");
  std::map<std::string, std::string> bindings;
  for (const std::string& name : condition.query_names) {
    const Candidate& candidate = bindings_.at(name);
    const auto largest =
        std::max_element(candidate.fragments.begin(), candidate.fragments.end(), [&](FragmentIndex a, FragmentIndex b) {
          const double points_a = state_.fragments.shapeOf(a).points, points_b = state_.fragments.shapeOf(b).points;
          return points_a != points_b ? points_a < points_b : state_.fragments.before(b, a);
        });
    bindings[name] = rdf::iriOfPrimitive(state_.scene.primitives[state_.fragments[*largest].primitive].id);
  }
  try {
    return state_.context.oracle->ask(condition.query, bindings);
  } catch (const InputError& fault) {
    throw InputError(condition.at,
                     "the query of rule '" + rule_.id + "' is faulty: " + fault.diagnostics().front().message,
                     fault.diagnostics().front().hint);
  }
}

}  // namespace cluxel::rules
