// SPDX-License-Identifier: Apache-2.0
// One small function per kind of condition.
#include "reasoning/condition_eval.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "reasoning/pair_measures.hpp"

namespace cluxel {

namespace {

constexpr double kGroundTolerance_m = 0.30;  // touches_ground without `within`, as relationInfos() says

std::string_view stepUnit(const Condition& condition) {
  if (condition.kind == Condition::Kind::Attribute) {
    const Dimension dimension = attributeInfos()[static_cast<std::size_t>(condition.attribute)].dimension;
    return dimension == Dimension::Angle ? "rad" : unitOf(dimension);
  }
  return condition.kind == Condition::Kind::Pair && condition.measure == PairMeasure::AdjacentFraction ? "" : "m";
}

/// Of an interval, the end that is nearer to the value is what a change would have to pass.
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
  using Kind = Condition::Kind;
  if (condition.kind == Kind::All || condition.kind == Kind::Any) {
    const bool all = condition.kind == Kind::All;
    bool outcome = all;
    for (const Condition& operand : condition.operands) {
      // A query is asked only when it can still matter.
      if (operand.kind == Kind::Ask && outcome != all) continue;
      const bool passed = holds(operand, steps);
      outcome = all ? outcome && passed : outcome || passed;
      if (steps == nullptr && outcome != all) break;
    }
    return outcome;
  }
  if (condition.kind == Kind::Not && !condition.operands.front().operands.empty())
    return !holds(condition.operands.front(), steps);
  DecisionStep step;
  const bool negative = condition.kind == Kind::Not;
  const bool passed = holdsElementary(negative ? condition.operands.front() : condition, step) != negative;
  if (steps == nullptr) return passed;
  step.rule_id = rule_.id;
  step.test = describe(condition);
  step.file = condition.at.file;
  step.line = condition.at.line;
  step.passed = passed;
  steps->push_back(std::move(step));
  return passed;
}

bool ConditionEvaluator::allHold(const std::vector<Condition>& conditions) {
  // What is measured already is tested before what has to be measured; the outcome is the same.
  const auto isCheap = [](const Condition& c) {
    return c.kind == Condition::Kind::Attribute && !c.slice && !c.ratio_slice;
  };
  return std::all_of(conditions.begin(), conditions.end(),
                     [&](const Condition& c) { return !isCheap(c) || holds(c); }) &&
         std::all_of(conditions.begin(), conditions.end(), [&](const Condition& c) { return isCheap(c) || holds(c); });
}

bool ConditionEvaluator::holdsElementary(const Condition& condition, DecisionStep& step) {
  using Kind = Condition::Kind;
  const Thing& subject = bindings_.at(condition.of);
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
      return std::all_of(subject.pieces.begin(), subject.pieces.end(), [&](PieceIndex piece) {
        return std::find(condition.labels.begin(), condition.labels.end(), state_.pieces.labelOf(piece)) !=
               condition.labels.end();
      });
    case Kind::Class:
      return std::any_of(subject.pieces.begin(), subject.pieces.end(),
                         [&](PieceIndex piece) { return state_.belongsTo(piece, condition.class_iri); });
    default:
      return holds(condition);
  }
}

bool ConditionEvaluator::holdsAttribute(const Condition& condition, DecisionStep& step) {
  const auto value = measured(condition.of, condition.slice, condition.attribute);
  std::optional<double> threshold;
  if (!condition.ratio_attribute)
    threshold = condition.value->value;
  else if (const auto other = measured(condition.ratio_of, condition.ratio_slice, *condition.ratio_attribute))
    threshold = condition.ratio * *other;
  step.measured = value;
  step.unit = stepUnit(condition);
  if (!value || !threshold) return false;  // nothing is in the slice
  step.threshold = nearerThreshold(condition, *value, *threshold);
  return compare(condition, *value, *threshold);
}

std::optional<double> ConditionEvaluator::measured(const std::string& of, const std::optional<SliceSpec>& slice,
                                                   Attribute attribute) const {
  const Thing& thing = bindings_.at(of);
  if (!slice) return thing.shape[attribute];
  const std::optional<Shape> shape = state_.pieces.shapeOfSlice(thing, *slice);
  return shape ? std::optional((*shape)[attribute]) : std::nullopt;
}

bool ConditionEvaluator::fits(PieceIndex piece, const Target& target) const {
  if (!target.labels.empty()) {
    const PrimitiveLabel label = state_.pieces.labelOf(piece);
    if (std::find(target.labels.begin(), target.labels.end(), label) == target.labels.end()) return false;
  }
  return target.kind != Target::Kind::Object || state_.belongsTo(piece, target.object_class);
}

void ConditionEvaluator::remember(PieceIndex piece, const Target& target) {
  if (target.kind != Target::Kind::Object) return;
  const OwnerIndex owner = state_.pieces[piece].owner;
  if (owner < state_.objects.size()) related_ = owner;
}

std::optional<std::pair<PieceIndex, double>> ConditionEvaluator::nearestTarget(const Condition& condition,
                                                                               double limit_m) {
  const Thing& subject = bindings_.at(condition.of);
  std::optional<std::pair<PieceIndex, double>> best;
  for (PrimitiveIndex primitive : state_.grid.primitivesNear(state_.pieces.cluxelsOf(subject), limit_m))
    for (PieceIndex piece : state_.pieces.piecesOf(primitive)) {
      if (!fits(piece, *condition.target) || std::binary_search(subject.pieces.begin(), subject.pieces.end(), piece))
        continue;
      const double measure = measurePair(state_, condition.measure, subject, state_.pieces.thingOf({piece}), limit_m);
      const bool share = condition.measure == PairMeasure::AdjacentFraction;
      const bool better = !best || (share ? measure > best->second : measure < best->second) ||
                          (measure == best->second && state_.pieces.before(piece, best->first));
      if (better) best = {piece, measure};
    }
  return best;
}

bool ConditionEvaluator::holdsPair(const Condition& condition, DecisionStep& step) {
  const double threshold = condition.value->value;
  const bool share = condition.measure == PairMeasure::AdjacentFraction;
  double measured = share ? 0 : std::numeric_limits<double>::infinity();
  const double limit =
      share ? 0.5 : std::max(threshold, condition.upper ? condition.upper->value : 0) + kMeasureMargin_m;
  if (condition.target->kind == Target::Kind::Name) {
    measured =
        measurePair(state_, condition.measure, bindings_.at(condition.of), bindings_.at(condition.target->name), limit);
  } else if (const auto nearest = nearestTarget(condition, limit)) {
    measured = nearest->second;
    if (compare(condition, measured, threshold)) remember(nearest->first, *condition.target);
  }
  if (std::isfinite(measured)) step.measured = measured;
  step.threshold = nearerThreshold(condition, measured, threshold);
  step.unit = stepUnit(condition);
  return compare(condition, measured, threshold);
}

bool ConditionEvaluator::holdsRelation(const Condition& condition, DecisionStep& step) {
  const Thing& subject = bindings_.at(condition.of);
  if (condition.value) {
    step.threshold = condition.value->value;
    step.unit = "m";
  }
  if (condition.relation == RelationKind::TouchesGround) {
    step.measured = subject.shape[Attribute::Bottom];
    step.threshold = condition.value ? condition.value->value : kGroundTolerance_m;
    step.unit = "m";
    return *step.measured <= *step.threshold;
  }
  std::optional<std::pair<PieceIndex, double>> best;
  if (condition.target->kind == Target::Kind::Name) {
    const auto measure = relationMeasure(state_, condition.relation, subject, bindings_.at(condition.target->name));
    if (measure) best = {subject.pieces.front(), *measure};
  } else {
    for (const auto& [piece, measure] : relatedPieces(state_, condition.relation, subject)) {
      if (!fits(piece, *condition.target)) continue;
      const bool better =
          !best || measure < best->second || (measure == best->second && state_.pieces.before(piece, best->first));
      if (better) best = {piece, measure};
    }
  }
  if (!best) return false;
  step.measured = best->second;
  const bool passed = !condition.value || best->second <= condition.value->value;
  if (passed && condition.target->kind != Target::Kind::Name) remember(best->first, *condition.target);
  return passed;
}

bool ConditionEvaluator::holdsAsk(const Condition& condition) {
  if (state_.context.oracle == nullptr)
    throw Error(ExitCode::FaultyInput, toString(condition.at) + ": rule '" + rule_.id +
                                           "' asks the map, but there is no map to ask here; build or open one");
  std::map<std::string, std::string> bindings;
  for (const std::string& name : condition.query_names) {
    const Thing& thing = bindings_.at(name);
    const auto largest = std::max_element(thing.pieces.begin(), thing.pieces.end(), [&](PieceIndex a, PieceIndex b) {
      const double points_a = state_.pieces.shapeOf(a).points, points_b = state_.pieces.shapeOf(b).points;
      return points_a != points_b ? points_a < points_b : state_.pieces.before(b, a);
    });
    bindings[name] = iriOf(state_.scene.primitives[state_.pieces[*largest].primitive]);
  }
  try {
    return state_.context.oracle->ask(condition.query, bindings);
  } catch (const InputError& fault) {
    throw InputError(condition.at,
                     "the query of rule '" + rule_.id + "' is faulty: " + fault.diagnostics().front().message,
                     fault.diagnostics().front().hint);
  }
}

}  // namespace cluxel
