// SPDX-License-Identifier: Apache-2.0
// Measured values that are taken to be others: what would a rule say then?
#pragma once

#include <optional>
#include <vector>

#include "rules/decide/reasoning_state.hpp"
#include "rules/language/rule_condition.hpp"

namespace cluxel::rules {

/// Stands in Bindings during a walk. A value is known by what it measures (an attribute of a slice, a gap to things of
/// a label) and by the fragments that it was measured on, not by names: another thing that gets the name later keeps
/// its own values.
class ChangedValues {
 public:
  /// Takes `value` [SI] for what an elementary test measures. Of two values for one measure the one farther from
  /// `measured` stays: it turns both tests when both values lie on one side of `measured`. When they do not, no value
  /// may turn both; the walk then tells what comes out.
  void set(const Condition& test, const Bindings& bindings, double measured, double value);
  /// What the test or line of evidence measures instead; absent when that has not changed.
  std::optional<double> of(const Condition& test, const Bindings& bindings) const;
  std::optional<double> of(const Candidate& candidate, const std::optional<SliceSpec>& slice,
                           perception::Attribute attribute) const;

 private:
  struct Change {
    Condition test;
    std::vector<FragmentIndex> subject, target;
    double measured = 0, value = 0;
  };
  std::vector<Change> changes_;
};

}  // namespace cluxel::rules
