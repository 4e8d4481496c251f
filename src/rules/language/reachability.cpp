// SPDX-License-Identifier: Apache-2.0
// Finds unreachable branches: interval analysis of the attribute tests on the path to a node.
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One end of an interval, with the description of the test that set it.
struct Bound {
  double value = 0;
  bool open = false;
  std::string why;
};

struct Interval {
  Bound low, high;
  bool empty() const { return low.value > high.value || (low.value == high.value && (low.open || high.open)); }
};

Interval naturalRange(perception::Attribute attribute) {
  Interval range{{-kInfinity, false, ""}, {kInfinity, false, ""}};
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

/// Attributes with two names share one interval.
perception::Attribute canonical(perception::Attribute attribute) {
  if (attribute == perception::Attribute::HorizontalExtent) return perception::Attribute::Length;
  if (attribute == perception::Attribute::HorizontalThickness) return perception::Attribute::Width;
  return attribute;
}

/// What the tests on the path imply about the bound candidates.
class Knowledge {
 public:
  void setLabels(const std::string& name, const std::vector<scan::PrimitiveLabel>& labels) {
    unsigned mask = 0;
    for (scan::PrimitiveLabel label : labels) mask |= 1U << static_cast<unsigned>(label);
    if (mask != 0) labels_[name] = mask;
  }

  /// Adds the fact that `condition` evaluated to `truth`. Returns the contradiction when that is impossible.
  std::optional<std::string> learn(const Condition& condition, bool truth) {
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

 private:
  /// When `truth`, every operand evaluated to `each`; otherwise at least one did not.
  std::optional<std::string> learnJoined(const std::vector<Condition>& operands, bool each, bool truth) {
    if (truth) {
      for (const Condition& operand : operands)
        if (auto why = learn(operand, each)) return why;
      return std::nullopt;
    }
    std::optional<std::string> why;
    const Condition* only_open = nullptr;
    for (const Condition& operand : operands) {
      Knowledge supposed = *this;
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

  std::optional<std::string> learnLabel(const Condition& condition, bool truth) {
    const auto known = labels_.find(condition.of);
    if (known == labels_.end() || condition.value) return std::nullopt;  // a share says nothing about each label
    unsigned mask = 0;
    for (scan::PrimitiveLabel label : condition.labels) mask |= 1U << static_cast<unsigned>(label);
    known->second &= truth ? mask : ~mask;
    if (known->second != 0) return std::nullopt;
    return "no label that '" + condition.of + "' may have is left over";
  }

  std::optional<std::string> learnAttribute(const Condition& condition, bool truth) {
    if (!condition.value || condition.ratio_attribute) return std::nullopt;
    const SliceSpec slice = condition.slice.value_or(SliceSpec{-kInfinity, kInfinity});
    const Key key{condition.of, slice.from_m, slice.to_m, canonical(condition.attribute)};
    // A failed test of a slice may mean that the slice is empty. It implies a bound only after another test of the same
    // slice has passed.
    if (condition.slice && !truth && !intervals_.contains(key)) return std::nullopt;
    Interval& known = intervals_.try_emplace(key, naturalRange(condition.attribute)).first->second;
    const Comparison comparison = truth ? condition.comparison : negated(condition.comparison);
    const std::string words = (truth ? "'" : "not '") + describe(condition) + "'";
    const double value = condition.value->value;
    Interval next = known;
    auto raise = [&](double low, bool open) {
      if (low > next.low.value || (low == next.low.value && open && !next.low.open)) next.low = {low, open, words};
    };
    auto lower = [&](double high, bool open) {
      if (high < next.high.value || (high == next.high.value && open && !next.high.open))
        next.high = {high, open, words};
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

  /// Bound name, slice (from, to), attribute.
  using Key = std::tuple<std::string, double, double, perception::Attribute>;
  std::map<Key, Interval> intervals_;
  std::map<std::string, unsigned> labels_;
};

class ReachabilityCheck {
 public:
  ReachabilityCheck(const Rule& rule, FaultList& faults) : rule_(rule), faults_(faults) {}

  void visit(NodeIndex index, const Knowledge& knowledge) {
    const TreeNode& node = rule_.nodes[index];
    if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
      follow(branch->yes, branch->condition, true, knowledge);
      follow(branch->no, branch->condition, false, knowledge);
    } else if (const auto* find = std::get_if<FindNode>(&node.what)) {
      visitFind(node, *find, knowledge);
    }
  }

 private:
  void follow(NodeIndex below, const Condition& condition, bool truth, Knowledge knowledge) {
    if (below == 0) return;
    if (const auto why = knowledge.learn(condition, truth))
      return faults_.error(rule_.nodes[below].at, "nothing can get here: " + *why,
                           "the test stands in line " + std::to_string(condition.at.line));
    visit(below, knowledge);
  }

  void visitFind(const TreeNode& node, const FindNode& find, const Knowledge& knowledge) {
    Knowledge inside = knowledge;
    inside.setLabels(find.name, find.labels);
    for (const Condition& condition : find.where)
      if (find.choose != Choice::All)
        if (const auto why = inside.learn(condition, true)) {
          faults_.error(node.at, "nothing can be found: " + *why,
                        "the test stands in line " + std::to_string(condition.at.line));
          if (find.missing != 0) visit(find.missing, knowledge);
          return;
        }
    if (find.found != 0) visit(find.found, inside);
    if (find.missing != 0) visit(find.missing, knowledge);
  }

  const Rule& rule_;
  FaultList& faults_;
};

}  // namespace

void checkReachability(const Rule& rule, FaultList& faults) {
  if (rule.nodes.empty()) return;
  Knowledge knowledge;
  if (!rule.group) {
    knowledge.setLabels(rule.seed.name, rule.seed.labels);
    // A slice is measured on its own: tests of the whole seed imply nothing about it.
    if (!rule.seed.slice)
      for (const Condition& condition : rule.seed.where)
        if (const auto why = knowledge.learn(condition, true))
          return faults.error(condition.at, "no seed can pass: " + *why);
  }
  ReachabilityCheck(rule, faults).visit(0, knowledge);
}

}  // namespace cluxel::rules
