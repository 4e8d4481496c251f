// SPDX-License-Identifier: Apache-2.0
// Writes tables of what the language knows and lists of what the rules say.
#include "tasks/rule_reference/rule_reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/quantile.hpp"
#include "rules/propose/candidate.hpp"

namespace cluxel::tasks {

namespace {

using Measures = std::array<double, perception::kAttributeCount>;

std::string unitText(perception::Dimension dimension) {
  const std::string unit(rules::unitOf(dimension));
  return unit.empty() ? "1" : unit;
}

std::string numberText(double value, perception::Dimension dimension) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g",
                dimension == perception::Dimension::Angle ? value * 180 / std::numbers::pi : value);
  return text;
}

/// Within a cell of a table.
std::string cellText(std::string_view text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? std::string("\\|") : std::string(1, c);
  return safe;
}

std::string languageText() {
  std::string text = "## Attributes\n\n| attribute | unit | meaning |\n|---|---|---|\n";
  for (const perception::AttributeInfo& info : perception::attributeInfos())
    text += "| `" + std::string(info.name) + "` | " + unitText(info.dimension) + " | " + cellText(info.help) + " |\n";
  text += "\n## Relations\n\n| relation | holds when |\n|---|---|\n";
  for (const perception::RelationInfo& info : perception::relationInfos())
    text += "| `" + std::string(info.name) + "` | " + cellText(info.help) + " |\n";
  text += "\n## Measures between two things\n\n| measure | unit | meaning |\n|---|---|---|\n";
  const std::array<std::pair<rules::PairMeasure, std::string_view>, 5> measures{{
      {rules::PairMeasure::Gap, "m | smallest distance of their cluxels' boxes"},
      {rules::PairMeasure::HorizontalGap, "m | the same in plan view"},
      {rules::PairMeasure::VerticalGap, "m | height between their vertical extents"},
      {rules::PairMeasure::AxisDistance, "m | distance in plan view of the centroid from the other's axis"},
      {rules::PairMeasure::AdjacentFraction, "1 | share of the outward cluxel edges that lead to the other"},
  }};
  for (const auto& [measure, meaning] : measures)
    text += "| `" + std::string(nameOf(measure)) + "` | " + std::string(meaning) + " |\n";
  return text;
}

class RuleText {
 public:
  RuleText(const rules::RuleSet& rules, const rules::Rule& rule) : rules_(rules), rule_(rule) {}

  std::string write() {
    text_ = "#### " + rule_.id + "\n\n" + (rule_.description.empty() ? "" : rule_.description + "\n\n");
    line(0, "seed: " + labels(rule_.seed.labels) + conditions(rule_.seed.where));
    if (rule_.group) line(0, "group: " + labels(rule_.group->labels) + conditions(rule_.group->limits));
    for (const rules::EvidenceLine& evidence : rule_.evidence) line(0, "evidence: " + describe(evidence));
    if (!rule_.nodes.empty()) node(0, 0, "");
    return text_ + "\n";
  }

 private:
  void line(std::size_t depth, const std::string& words) { text_ += std::string(2 * depth, ' ') + "- " + words + "\n"; }

  static std::string labels(const std::vector<scan::PrimitiveLabel>& list) {
    std::string text;
    for (const scan::PrimitiveLabel label : list) text += (text.empty() ? "" : " or ") + std::string(nameOf(label));
    return text;
  }

  static std::string conditions(const std::vector<rules::Condition>& list) {
    std::string text;
    for (const rules::Condition& condition : list) text += (text.empty() ? ", with " : ", ") + describe(condition);
    return text;
  }

  void node(std::size_t depth, rules::NodeIndex index, const std::string& way) {
    const auto& what = rule_.nodes[index].what;
    if (const auto* branch = std::get_if<rules::BranchNode>(&what)) {
      line(depth, way + describe(branch->condition));
      node(depth + 1, branch->yes, "yes: ");
      node(depth + 1, branch->no, "no: ");
    } else if (const auto* find = std::get_if<rules::FindNode>(&what)) {
      line(depth, way + "find " + find->name + ": " + labels(find->labels) + conditions(find->where));
      node(depth + 1, find->found, "found: ");
      node(depth + 1, find->missing, "missing: ");
    } else if (const auto* reject = std::get_if<rules::RejectLeaf>(&what)) {
      line(depth, way + "no: " + reject->reason);
    } else {
      line(depth, way + "accept" + partsOf(std::get<rules::AcceptLeaf>(what)));
    }
  }

  std::string partsOf(const rules::AcceptLeaf& accept) const {
    std::string text;
    for (const auto& [name, part] : accept.parts)
      text += (text.empty() ? ": " : ", ") + name + " is " + rules_.shorten(part);
    return text;
  }

  const rules::RuleSet& rules_;
  const rules::Rule& rule_;
  std::string text_;
};

std::string tableOf(const std::vector<Measures>& objects) {
  std::string text = "\n| attribute | unit | 5 % | 50 % | 95 % |\n|---|---|---|---|---|\n";
  for (const perception::AttributeInfo& info : perception::attributeInfos()) {
    std::vector<double> values;
    for (const Measures& object : objects)
      if (const double value = object[static_cast<std::size_t>(info.attribute)]; std::isfinite(value))
        values.push_back(value);
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    text += "| `" + std::string(info.name) + "` | " + unitText(info.dimension) + " |";
    for (const double share : {0.05, 0.5, 0.95})
      text += " " + numberText(quantileOf(values, share), info.dimension) + " |";
    text += "\n";
  }
  return text;
}

}  // namespace

void MeasuredClasses::add(const mapping::MapReader& map) {
  ++maps_;
  const perception::Scene& scene = map.scene();
  for (const rules::SemanticObject& object : map.objects()) {
    std::vector<std::uint32_t> cluxels;
    std::set<perception::PrimitiveIndex> members;
    for (const rules::ObjectPart& part : object.parts) {
      cluxels.insert(cluxels.end(), part.cluxels.begin(), part.cluxels.end());
      members.insert(part.primitives.begin(), part.primitives.end());
    }
    std::sort(cluxels.begin(), cluxels.end());
    std::vector<perception::PrimitiveIndex> all(members.begin(), members.end()), whole;
    for (const perception::PrimitiveIndex member : all) {
      const auto& own = scene.primitives[member].cluxels;
      if (std::includes(cluxels.begin(), cluxels.end(), own.begin(), own.end())) whole.push_back(member);
    }
    values_[object.class_iri].push_back(rules::shapeOfCluxels(scene, cluxels, all, whole).attributes);
  }
}

std::string referenceOf(const rules::RuleSet& rules, const MeasuredClasses& measured) {
  std::string text = "# Rules: " + rules.name + (rules.version.empty() ? "" : " " + rules.version) + "\n\n" +
                     rules.description + "\n\n" + languageText() + "\n## Classes and their rules\n";
  if (measured.maps() > 0)
    text += "\nThe tables are measured on the objects of " + std::to_string(measured.maps()) +
            (measured.maps() == 1 ? " map" : " maps") + ", as these maps name them.\n";
  for (const std::string& iri : rules.order) {
    text += "\n### " + rules.shorten(iri) + "\n";
    const auto objects = measured.values().find(iri);
    if (objects != measured.values().end())
      text += "\n" + std::to_string(objects->second.size()) +
              (objects->second.size() == 1 ? " object\n" : " objects\n") + tableOf(objects->second);
    text += "\n";
    for (const rules::Rule& rule : rules.rules)
      if (rule.class_iri == iri) text += RuleText(rules, rule).write();
  }
  return text;
}

}  // namespace cluxel::tasks
