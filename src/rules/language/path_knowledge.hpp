// SPDX-License-Identifier: Apache-2.0
// What tests on the way to a node imply: an interval for each attribute, and the labels that are left.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "rules/language/rule_condition.hpp"

namespace cluxel::rules {

/// One end of an interval, with the description of the test that set it.
struct IntervalEnd {
  double value = 0;
  bool open = false;
  std::string why;
};

struct AttributeInterval {
  IntervalEnd low, high;
  bool empty() const { return low.value > high.value || (low.value == high.value && (low.open || high.open)); }
  bool contains(double value) const;
};

/// Attributes with two names are known under one.
perception::Attribute canonical(perception::Attribute attribute);

class PathKnowledge {
 public:
  void setLabels(const std::string& name, const std::vector<scan::PrimitiveLabel>& labels);
  /// Adds the fact that `condition` evaluated to `truth`. Returns the contradiction when that is impossible.
  std::optional<std::string> learn(const Condition& condition, bool truth);
  /// True when what is known excludes the opposite result. Knows nothing of ratios, relations and queries.
  bool implies(const Condition& condition, bool truth) const;

  /// The intervals of the whole of what is bound to a name.
  std::map<perception::Attribute, AttributeInterval> intervalsOf(const std::string& name) const;
  std::vector<scan::PrimitiveLabel> labelsOf(const std::string& name) const;

 private:
  /// When `truth`, every operand evaluated to `each`; otherwise at least one did not.
  std::optional<std::string> learnJoined(const std::vector<Condition>& operands, bool each, bool truth);
  std::optional<std::string> learnLabel(const Condition& condition, bool truth);
  std::optional<std::string> learnAttribute(const Condition& condition, bool truth);

  /// Bound name, slice (from, to), attribute.
  using Key = std::tuple<std::string, double, double, perception::Attribute>;
  std::map<Key, AttributeInterval> intervals_;
  std::map<std::string, unsigned> labels_;
};

}  // namespace cluxel::rules
