// SPDX-License-Identifier: Apache-2.0
// Descriptions of conditions, and look-ups in a rule set.
#include "rules/language/rule_set.hpp"

#include <algorithm>

#include "base/ascii.hpp"
#include "base/text/short_number.hpp"
#include "rdf/iri.hpp"

namespace cluxel::rules {

namespace {

std::string labelList(const std::vector<scan::PrimitiveLabel>& labels) {
  std::string text;
  for (scan::PrimitiveLabel label : labels) text += (text.empty() ? "" : " or ") + std::string(nameOf(label));
  return text;
}

std::string describeTarget(const Target& target) {
  if (target.kind == Target::Kind::Name) return target.name;
  if (target.kind == Target::Kind::Labels) return withArticle(labelList(target.labels));
  return withArticle(rdf::localName(target.object_class));
}

/// "height of pole", "height of pole from 0 m to 1.2 m".
std::string describeMeasured(perception::Attribute attribute, const std::string& of,
                             const std::optional<SliceSpec>& slice) {
  std::string text = std::string(perception::attributeInfos()[static_cast<std::size_t>(attribute)].name) + " of " + of;
  if (slice) text += " from " + shortNumber(slice->from_m) + " m to " + shortNumber(slice->to_m) + " m";
  return text;
}

std::string describeThreshold(const Condition& condition) {
  if (condition.ratio_attribute) {
    return std::string(symbolOf(condition.comparison)) + " " + shortNumber(condition.ratio) + " x " +
           describeMeasured(*condition.ratio_attribute, condition.ratio_of, condition.ratio_slice);
  }
  if (!condition.value) return {};
  const std::string value = condition.value->text;
  if (condition.upper)
    return std::string(symbolOf(condition.comparison)) + " " + value + " and " + condition.upper->text;
  return std::string(symbolOf(condition.comparison)) + " " + value;
}

std::string describeAll(const Condition& condition) {
  std::string text;
  for (const Condition& operand : condition.operands)
    text += (text.empty() ? "" : condition.kind == Condition::Kind::All ? " and " : " or ") + describe(operand);
  return condition.operands.size() > 1 ? "(" + text + ")" : text;
}

}  // namespace

std::string withArticle(std::string_view name) {
  const auto is_vowel = [&](std::size_t i) {
    return i < name.size() && std::string_view("aeiou").find(lowerAscii(name[i])) != std::string_view::npos;
  };
  // "Utility" and "Usual" begin with the sound of "you": a vowel, a consonant, a vowel.
  const bool is_you = !name.empty() && lowerAscii(name[0]) == 'u' && !is_vowel(1) && is_vowel(2);
  return (is_vowel(0) && !is_you ? "an " : "a ") + std::string(name);
}

bool looksNearby(const Condition& c, std::string_view subject) {
  if (c.of != subject || !c.target || c.target->kind != Target::Kind::Name) return false;
  if (c.kind == Condition::Kind::Relation) return c.relation != perception::RelationKind::TouchesGround;
  if (c.kind != Condition::Kind::Pair || c.measure == PairMeasure::VerticalGap) return false;
  if (c.measure == PairMeasure::AdjacentFraction)
    return c.comparison == Comparison::Greater || c.comparison == Comparison::GreaterEqual;
  return c.comparison == Comparison::Less || c.comparison == Comparison::LessEqual ||
         c.comparison == Comparison::Between;
}

Comparison negated(Comparison comparison) {
  switch (comparison) {
    case Comparison::Less:
      return Comparison::GreaterEqual;
    case Comparison::LessEqual:
      return Comparison::Greater;
    case Comparison::Greater:
      return Comparison::LessEqual;
    case Comparison::GreaterEqual:
      return Comparison::Less;
    case Comparison::Equal:
      return Comparison::NotEqual;
    case Comparison::NotEqual:
      return Comparison::Equal;
    case Comparison::Between:
      return Comparison::Outside;
    case Comparison::Outside:
      break;
  }
  return Comparison::Between;
}

std::string_view symbolOf(Comparison comparison) {
  switch (comparison) {
    case Comparison::Less:
      return "<";
    case Comparison::LessEqual:
      return "<=";
    case Comparison::Greater:
      return ">";
    case Comparison::GreaterEqual:
      return ">=";
    case Comparison::Equal:
      return "=";
    case Comparison::NotEqual:
      return "!=";
    case Comparison::Between:
      return "between";
    case Comparison::Outside:
      break;
  }
  return "outside";
}

std::string_view nameOf(PairMeasure measure) {
  switch (measure) {
    case PairMeasure::Gap:
      return "gap";
    case PairMeasure::HorizontalGap:
      return "horizontal_gap";
    case PairMeasure::VerticalGap:
      return "vertical_gap";
    case PairMeasure::AxisDistance:
      return "axis_distance";
    case PairMeasure::AdjacentFraction:
      break;
  }
  return "adjacent_fraction";
}

/// The tests of ends in a condition, without the others.
std::string describeEnds(const Condition& condition) {
  if (condition.kind == Condition::Kind::Attribute)
    return !condition.slice && perception::isOfAnEnd(condition.attribute) ? describe(condition) : "";
  std::string text;
  for (const Condition& operand : condition.operands)
    if (const std::string part = describeEnds(operand); !part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string describe(const Condition& condition) {
  using Kind = Condition::Kind;
  switch (condition.kind) {
    case Kind::Attribute:
      return describeMeasured(condition.attribute, condition.of, condition.slice) + " " + describeThreshold(condition);
    case Kind::Pair:
      return std::string(nameOf(condition.measure)) + " of " + condition.of + " to " +
             describeTarget(*condition.target) + " " + describeThreshold(condition);
    case Kind::Relation:
      return condition.of + " " +
             std::string(perception::relationInfos()[static_cast<std::size_t>(condition.relation)].name) +
             (condition.target ? " " + describeTarget(*condition.target) : "") +
             (condition.value ? " within " + condition.value->text : "");
    case Kind::Label:
      if (condition.value)
        return labelList(condition.labels) + " share of " + condition.of + " " + describeThreshold(condition);
      return condition.of + " is labelled " + labelList(condition.labels);
    case Kind::Class:
      return condition.of + " belongs to " + withArticle(rdf::localName(condition.class_iri));
    case Kind::Ask: {
      const std::size_t body = condition.query.rfind("PREFIX ");
      const std::size_t start = body == std::string::npos ? 0 : condition.query.find('\n', body) + 1;
      return condition.query.substr(start);
    }
    case Kind::All:
    case Kind::Any:
      return describeAll(condition);
    case Kind::Not:
      return "not " + describe(condition.operands.front());
    case Kind::Unseen:
      return "unseen: " + describeEnds(condition.operands.front());
  }
  return {};
}

std::string describe(const EvidenceLine& line) {
  const Condition& measure = line.measure;
  if (line.kind == EvidenceLine::Kind::Test) return describe(measure);
  if (measure.kind == Condition::Kind::Pair)
    return std::string(nameOf(measure.measure)) + " of " + measure.of + " to " + describeTarget(*measure.target) +
           (line.asks_rivals ? " of the first round" : "");
  std::string text = describeMeasured(measure.attribute, measure.of, measure.slice);
  if (measure.ratio_attribute)
    text += " relative to " + describeMeasured(*measure.ratio_attribute, measure.ratio_of, measure.ratio_slice);
  return text;
}

ContentHash RuleSet::hash() const {
  ContentHasher hasher;
  for (const RuleSource& source : sources) hasher.addText(source.text);
  return hasher.finish();
}

const Rule* RuleSet::find(std::string_view id) const {
  const auto found = std::find_if(rules.begin(), rules.end(), [&](const Rule& rule) { return rule.id == id; });
  return found == rules.end() ? nullptr : &*found;
}

std::string RuleSet::shorten(std::string_view iri) const {
  for (const auto& [prefix, base] : prefixes)
    if (!base.empty() && iri.starts_with(base)) return prefix + ":" + std::string(iri.substr(base.size()));
  return std::string(iri);
}

}  // namespace cluxel::rules
