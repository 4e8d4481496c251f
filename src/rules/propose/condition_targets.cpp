// SPDX-License-Identifier: Apache-2.0
// What a condition compares its subject with: the nearest of the things that fit the target.
#include <algorithm>
#include <utility>

#include "rules/propose/condition_eval.hpp"
#include "rules/propose/pair_measures.hpp"

namespace cluxel::rules {

namespace {

/// Subjects of more cluxels are compared with one target after the other.
constexpr double kMaxScanned = 500;

}  // namespace

std::optional<double> ConditionEvaluator::gapToRivals(const Condition& condition, double limit_m) const {
  const std::vector<bool>* classes = state_.classesBelow(condition.target->object_class);
  if (classes == nullptr || state_.first_winners == nullptr) return std::nullopt;
  return state_.first_winners->nearestGap(state_, bindings_.at(condition.of), *classes,
                                          condition.measure == PairMeasure::HorizontalGap, limit_m);
}

bool ConditionEvaluator::hasLabel(FragmentIndex fragment, const Target& target) const {
  return target.labels.empty() || std::find(target.labels.begin(), target.labels.end(),
                                            state_.fragments.labelOf(fragment)) != target.labels.end();
}

bool ConditionEvaluator::fits(FragmentIndex fragment, const Target& target) const {
  return hasLabel(fragment, target) &&
         (target.kind != Target::Kind::Object || state_.belongsTo(fragment, target.object_class));
}

void ConditionEvaluator::remember(FragmentIndex fragment, const Target& target) {
  if (target.kind != Target::Kind::Object) return;
  const OwnerIndex owner = state_.fragments[fragment].owner;
  if (owner < state_.objects.size()) related_ = owner;
}

std::optional<std::pair<FragmentIndex, double>> ConditionEvaluator::nearestTarget(const Condition& condition,
                                                                                  double limit_m, bool far) {
  const Candidate& subject = bindings_.at(condition.of);
  if (condition.measure == PairMeasure::Gap && condition.target->kind == Target::Kind::Object && !far &&
      subject.shape[perception::Attribute::CluxelCount] <= kMaxScanned)
    return nearestObject(*condition.target, subject, limit_m);
  std::optional<std::pair<FragmentIndex, double>> best;
  for (perception::PrimitiveIndex primitive : state_.grid.primitivesNear(state_.fragments.cluxelsOf(subject), limit_m))
    for (FragmentIndex fragment : state_.fragments.fragmentsOf(primitive)) {
      if (!fits(fragment, *condition.target) ||
          std::binary_search(subject.fragments.begin(), subject.fragments.end(), fragment))
        continue;
      const double measure =
          measurePair(state_, condition.measure, subject, state_.fragments.candidateOf({fragment}), limit_m);
      const bool share = condition.measure == PairMeasure::AdjacentFraction;
      const bool better = !best || (share ? measure > best->second : measure < best->second) ||
                          (measure == best->second && state_.fragments.before(fragment, best->first));
      if (better) best = {fragment, measure};
    }
  return best;
}

std::optional<std::pair<FragmentIndex, double>> ConditionEvaluator::nearestObject(const Target& target,
                                                                                  const Candidate& subject,
                                                                                  double limit_m) const {
  const std::vector<bool>* classes = state_.classesBelow(target.object_class);
  if (classes == nullptr) return std::nullopt;
  std::optional<std::pair<FragmentIndex, double>> best;
  auto last = static_cast<FragmentIndex>(state_.fragments.size());  // most cluxels of a cell are of one fragment
  bool is_wanted = false;
  for (const FragmentIndex mine : subject.fragments)
    for (const std::uint32_t cluxel : state_.fragments[mine].cluxels)
      state_.grid.near(cluxel, best ? best->second : limit_m, [&](std::uint32_t other) {
        const FragmentIndex fragment = state_.fragments.fragmentOf(other);
        if (std::exchange(last, fragment) != fragment)
          is_wanted = state_.belongsToAny(fragment, classes) && hasLabel(fragment, target) &&
                      !std::binary_search(subject.fragments.begin(), subject.fragments.end(), fragment);
        if (!is_wanted) return;
        const double gap = gapBetween(state_.scene.cluxels, cluxel, other).gap();
        if (gap > limit_m || (best && gap > best->second)) return;
        if (!best || gap < best->second || state_.fragments.before(fragment, best->first)) best = {fragment, gap};
      });
  return best;
}

}  // namespace cluxel::rules
