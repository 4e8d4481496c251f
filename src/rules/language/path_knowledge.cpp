// SPDX-License-Identifier: Apache-2.0
// Interval analysis of attribute tests.
#include "rules/language/path_knowledge.hpp"

#include <limits>
#include <numbers>

namespace cluxel::rules {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

AttributeInterval naturalRange(perception::Attribute attribute) {
  AttributeInterval range{{-kInfinity, false, ""}, {kInfinity, false, ""}};
  switch (perception::attributeInfos()[static_cast<std::size_t>(attribute)].dimension) {
    case perception::Dimension::Length:
      if (attribute != perception::Attribute::Bottom && attribute != perception::Attribute::Top &&
          attribute != perception::Attribute::FreeHeightBelow)
        range.low = {0, false, "a length is never negative"};
      break;
    case perception::Dimension::Area:
    case perception::Dimension::Volume:
    case perception::Dimension::Count:
      range.low = {0, false, "it is never negative"};
      break;
    case perception::Dimension::Angle:
      range = {{0, false, "an angle is never negative"}, {std::numbers::pi / 2, false, "a tilt is at most 90 deg"}};
      break;
    case perception::Dimension::Ratio:
      if (attribute == perception::Attribute::MeanIntensity) break;  // unbounded: its scale depends on the sensor
      range.low = {0, false, "a share is never negative"};
      range.high = {1, false, "a share is at most 1"};
      break;
  }
  return range;
}

/// Whether no share of points, which lies between 0 and 1, passes the comparison.
bool isImpossibleShare(Comparison comparison, double value, double upper) {
  switch (comparison) {
    case Comparison::Less:
      return value <= 0;
    case Comparison::LessEqual:
      return value < 0;
    case Comparison::Greater:
      return value >= 1;
    case Comparison::GreaterEqual:
      return value > 1;
    case Comparison::Equal:
      return value < 0 || value > 1;
    case Comparison::Between:
      return upper < 0 || value > 1;
    default:
      return false;
  }
}

}  // namespace

bool AttributeInterval::contains(double value) const {
  return (value > low.value || (value == low.value && !low.open)) &&
         (value < high.value || (value == high.value && !high.open));
}

perception::Attribute canonical(perception::Attribute attribute) {
  if (attribute == perception::Attribute::HorizontalExtent) return perception::Attribute::Length;
  if (attribute == perception::Attribute::HorizontalThickness) return perception::Attribute::Width;
  return attribute;
}

void PathKnowledge::setLabels(const std::string& name, const std::vector<scan::PrimitiveLabel>& labels) {
  unsigned mask = 0;
  for (scan::PrimitiveLabel label : labels) mask |= 1U << static_cast<unsigned>(label);
  if (mask != 0) labels_[name] = mask;
}

std::optional<std::string> PathKnowledge::learn(const Condition& condition, bool truth) {
  switch (condition.kind) {
    case Condition::Kind::Attribute:
      return learnAttribute(condition, truth);
    case Condition::Kind::Label:
      return learnLabel(condition, truth);
    case Condition::Kind::Not:
      return learn(condition.operands.front(), !truth);
    case Condition::Kind::All:
      return learnJoined(condition.operands, true, truth);
    case Condition::Kind::Any:
      return learnJoined(condition.operands, false, !truth);
    default:
      return std::nullopt;
  }
}

bool PathKnowledge::implies(const Condition& condition, bool truth) const {
  PathKnowledge supposed = *this;
  return supposed.learn(condition, !truth).has_value();
}

std::map<perception::Attribute, AttributeInterval> PathKnowledge::intervalsOf(const std::string& name) const {
  std::map<perception::Attribute, AttributeInterval> found;
  for (const auto& [key, interval] : intervals_)
    if (std::get<0>(key) == name && std::get<1>(key) == -kInfinity) found.emplace(std::get<3>(key), interval);
  return found;
}

std::vector<scan::PrimitiveLabel> PathKnowledge::labelsOf(const std::string& name) const {
  std::vector<scan::PrimitiveLabel> labels;
  const auto known = labels_.find(name);
  for (std::size_t label = 0; known != labels_.end() && label < scan::kPrimitiveLabelCount; ++label)
    if ((known->second >> label & 1U) != 0) labels.push_back(static_cast<scan::PrimitiveLabel>(label));
  return labels;
}

std::optional<std::string> PathKnowledge::learnJoined(const std::vector<Condition>& operands, bool each, bool truth) {
  if (truth) {
    for (const Condition& operand : operands)
      if (auto why = learn(operand, each)) return why;
    return std::nullopt;
  }
  std::optional<std::string> why;
  const Condition* only_open = nullptr;
  for (const Condition& operand : operands) {
    PathKnowledge supposed = *this;
    if (auto contradiction = supposed.learn(operand, !each)) {
      why = contradiction;
    } else if (only_open != nullptr) {
      return std::nullopt;
    } else {
      only_open = &operand;
    }
  }
  return only_open == nullptr ? why : learn(*only_open, !each);
}

std::optional<std::string> PathKnowledge::learnLabel(const Condition& condition, bool truth) {
  if (condition.value) {  // a share says nothing about each label
    const Comparison comparison = truth ? condition.comparison : negated(condition.comparison);
    const double value = condition.value->value;
    if (!isImpossibleShare(comparison, value, condition.upper ? condition.upper->value : value)) return std::nullopt;
    return (truth ? "'" : "not '") + describe(condition) + "' cannot be: a share lies between 0 and 1";
  }
  const auto known = labels_.find(condition.of);
  if (known == labels_.end()) return std::nullopt;
  unsigned mask = 0;
  for (scan::PrimitiveLabel label : condition.labels) mask |= 1U << static_cast<unsigned>(label);
  known->second &= truth ? mask : ~mask;
  if (known->second != 0) return std::nullopt;
  return "no label that '" + condition.of + "' may have is left over";
}

std::optional<std::string> PathKnowledge::learnAttribute(const Condition& condition, bool truth) {
  if (!condition.value || condition.ratio_attribute) return std::nullopt;
  const SliceSpec slice = condition.slice.value_or(SliceSpec{-kInfinity, kInfinity});
  const Key key{condition.of, slice.from_m, slice.to_m, canonical(condition.attribute)};
  // A failed test of a slice may mean that the slice is empty. It implies a bound only after another test of the same
  // slice has passed.
  if (condition.slice && !truth && !intervals_.contains(key)) return std::nullopt;
  AttributeInterval& known = intervals_.try_emplace(key, naturalRange(condition.attribute)).first->second;
  const Comparison comparison = truth ? condition.comparison : negated(condition.comparison);
  const std::string words = (truth ? "'" : "not '") + describe(condition) + "'";
  const double value = condition.value->value;
  AttributeInterval next = known;
  auto raise = [&](double low, bool open) {
    if (low > next.low.value || (low == next.low.value && open && !next.low.open)) next.low = {low, open, words};
  };
  auto lower = [&](double high, bool open) {
    if (high < next.high.value || (high == next.high.value && open && !next.high.open)) next.high = {high, open, words};
  };
  switch (comparison) {
    case Comparison::Less:
      lower(value, true);
      break;
    case Comparison::LessEqual:
      lower(value, false);
      break;
    case Comparison::Greater:
      raise(value, true);
      break;
    case Comparison::GreaterEqual:
      raise(value, false);
      break;
    case Comparison::Equal:
      raise(value, false), lower(value, false);
      break;
    case Comparison::Between:
      raise(value, false), lower(condition.upper->value, false);
      break;
    case Comparison::Outside:
      if (known.low.value >= value && known.high.value <= condition.upper->value)
        next = {{1, false, ""}, {0, false, ""}};
      break;
    case Comparison::NotEqual:
      if (known.low.value == value && known.high.value == value) next = {{1, false, ""}, {0, false, ""}};
      break;
  }
  if (!next.empty()) {
    known = next;
    return std::nullopt;
  }
  const std::string& other = next.high.why == words ? next.low.why : next.high.why;
  return words + " contradicts " + (other.empty() || other == words ? "what was tested before" : other);
}

}  // namespace cluxel::rules
