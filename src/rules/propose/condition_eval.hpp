// SPDX-License-Identifier: Apache-2.0
// Evaluates conditions for bound candidates and records the measured values.
#pragma once

#include <optional>
#include <vector>

#include "rules/decide/reasoning_state.hpp"
#include "rules/propose/test_notes.hpp"

namespace cluxel::rules {

/// True when `value` passes the comparison with the condition's thresholds.
bool compare(const Condition& condition, double value, double threshold);

class ConditionEvaluator {
 public:
  ConditionEvaluator(const ReasoningState& state, const Rule& rule, const Bindings& bindings)
      : state_(state), rule_(rule), bindings_(bindings), notes_(state) {}

  /// Evaluates, and appends one step per elementary test to `steps` when given.
  bool holds(const Condition& condition, std::vector<DecisionStep>* steps = nullptr);
  bool allHold(const std::vector<Condition>& conditions);
  /// What a line of evidence measures; absent when a slice is empty. Distances are measured up to `reach`, and are
  /// `reach` beyond.
  std::optional<double> measure(const Condition& condition, double reach);
  /// "m", "rad" and the like.
  static std::string unitOf(const Condition& condition);
  /// The object found by the last relation or measure that passed.
  std::optional<OwnerIndex> related() const { return related_; }

 private:
  bool outcomeOf(const Condition& condition, std::vector<DecisionStep>* steps);
  bool holdsElementary(const Condition& condition, DecisionStep& step);
  bool holdsAttribute(const Condition& condition, DecisionStep& step);
  bool isUnseen(const Condition& condition, DecisionStep& step);
  /// Absent when the candidate has no cluxel in the slice.
  std::optional<double> measured(const std::string& of, const std::optional<SliceSpec>& slice,
                                 perception::Attribute attribute) const;
  /// `value`, or what counts instead of it (Bindings::changed).
  double orChanged(const Condition& condition, double value) const;
  bool holdsLabelShare(const Condition& condition, DecisionStep& step);
  bool holdsPair(const Condition& condition, DecisionStep& step);
  bool holdsRelation(const Condition& condition, DecisionStep& step);
  bool holdsAsk(const Condition& condition);
  bool hasLabel(FragmentIndex fragment, const Target& target) const;
  bool fits(FragmentIndex fragment, const Target& target) const;
  /// The fragment that fits the target and has the smallest measure, or the largest share. `far`: also when that is
  /// infinite.
  std::optional<std::pair<FragmentIndex, double>> nearestTarget(const Condition& condition, double limit_m, bool far);
  /// The same for gaps to objects, looked up around the subject's cluxels.
  std::optional<std::pair<FragmentIndex, double>> nearestObject(const Target& target, const Candidate& subject,
                                                                double limit_m) const;
  /// The smallest gap to an object of the target's class that won the first round.
  std::optional<double> gapToRivals(const Condition& condition, double limit_m) const;
  void remember(FragmentIndex fragment, const Target& target);

  const ReasoningState& state_;
  const Rule& rule_;
  const Bindings& bindings_;
  std::optional<OwnerIndex> related_;
  TestNotes notes_;
  int depth_ = 0;  ///< of evaluations within evaluations; the outermost hands over the notes
};

}  // namespace cluxel::rules
