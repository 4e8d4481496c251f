// SPDX-License-Identifier: Apache-2.0
// Compares what two conditions measure, whatever their thresholds are.
#include "rules/explain/changed_values.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::rules {

namespace {

using Kind = Condition::Kind;

/// `touches_ground` compares the bottom, as a test of this attribute does.
Condition measuredBy(const Condition& test) {
  if (test.kind != Kind::Relation || test.relation != perception::RelationKind::TouchesGround) return test;
  Condition bottom;
  bottom.kind = Kind::Attribute;
  bottom.of = test.of;
  bottom.attribute = perception::Attribute::Bottom;
  return bottom;
}

bool isSameSlice(const std::optional<SliceSpec>& a, const std::optional<SliceSpec>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->from_m == b->from_m && a->to_m == b->to_m;
}

/// Fragments of named targets are compared by the caller.
bool isSameTarget(const std::optional<Target>& a, const std::optional<Target>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->kind == b->kind && a->labels == b->labels && a->object_class == b->object_class;
}

bool measureTheSame(const Condition& a, const Condition& b) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case Kind::Attribute:
      return a.attribute == b.attribute && isSameSlice(a.slice, b.slice);
    case Kind::Pair:
      return a.measure == b.measure && a.asks_rivals == b.asks_rivals && isSameTarget(a.target, b.target);
    case Kind::Relation:
      return a.relation == b.relation && isSameTarget(a.target, b.target);
    case Kind::Label:
      return a.value.has_value() && b.value.has_value() && a.labels == b.labels;
    default:
      return false;
  }
}

std::vector<FragmentIndex> targetOf(const Condition& test, const Bindings& bindings) {
  const bool is_named = test.target && test.target->kind == Target::Kind::Name;
  return is_named ? bindings.at(test.target->name).fragments : std::vector<FragmentIndex>();
}

}  // namespace

void ChangedValues::set(const Condition& test, const Bindings& bindings, double measured, double value) {
  Change made{measuredBy(test), bindings.at(test.of).fragments, targetOf(test, bindings), measured, value};
  const auto known = std::find_if(changes_.begin(), changes_.end(), [&](const Change& change) {
    return change.subject == made.subject && change.target == made.target && measureTheSame(change.test, made.test);
  });
  if (known == changes_.end())
    changes_.push_back(std::move(made));
  else if (std::abs(value - measured) > std::abs(known->value - known->measured))
    *known = std::move(made);
}

std::optional<double> ChangedValues::of(const Condition& test, const Bindings& bindings) const {
  const Condition measure = measuredBy(test);
  const std::vector<FragmentIndex>& subject = bindings.at(test.of).fragments;
  for (const Change& change : changes_)
    if (change.subject == subject && measureTheSame(change.test, measure) && change.target == targetOf(test, bindings))
      return change.value;
  return std::nullopt;
}

std::optional<double> ChangedValues::of(const Candidate& candidate, const std::optional<SliceSpec>& slice,
                                        perception::Attribute attribute) const {
  for (const Change& change : changes_)
    if (change.test.kind == Kind::Attribute && change.test.attribute == attribute &&
        isSameSlice(change.test.slice, slice) && change.subject == candidate.fragments)
      return change.value;
  return std::nullopt;
}

}  // namespace cluxel::rules
