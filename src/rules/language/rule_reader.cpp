// SPDX-License-Identifier: Apache-2.0
// Reads one rule: its class, its seeds, how they are grouped, and its tree.
#include <algorithm>

#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

std::optional<double> readLength(const YamlNode& map, std::string_view key, RuleReading& reading) {
  const YamlNode* node = map.find(key);
  if (node == nullptr) return std::nullopt;
  const auto length = readQuantity(*node, perception::Dimension::Length, reading);
  if (!length) return std::nullopt;
  if (length->value < 0) reading.faults.error(node->at, "a distance cannot be negative");
  return length->value;
}

/// Seeds and groups are selected before any name is bound: only attributes of the candidate itself can be tested.
void onlyOwnAttributes(const std::vector<Condition>& conditions, FaultList& faults) {
  for (const Condition& condition : conditions) {
    using Kind = Condition::Kind;
    const bool other = condition.kind == Kind::Pair || condition.kind == Kind::Ask || condition.kind == Kind::Class ||
                       (condition.kind == Kind::Relation && condition.target);
    if (other) faults.error(condition.at, "only attributes can be tested here", "put this test into the tree");
    onlyOwnAttributes(condition.operands, faults);
  }
}

void readSeed(const YamlNode& node, SeedSpec& seed, RuleReading& reading) {
  if (!checkKeys(node, "seed", reading.faults)) return;
  if (const YamlNode* as = node.find("as")) seed.name = readNewName(*as, {}, reading.faults).value_or("seed");
  if (seed.name == "it")
    reading.faults.error(node.find("as")->at, "'it' is what may be absorbed", "choose another name");
  seed.labels = readLabels(node, reading);
  if (node.find("label") == nullptr && node.find("label_in") == nullptr)
    reading.faults.error(node.at, "'seed' needs 'label' or 'label_in'");
  if (const YamlNode* slice = node.find("slice")) seed.slice = readSlice(*slice, reading);
  if (const YamlNode* where = node.find("where"))
    seed.where = readConditions(*where, {{seed.name}, seed.name}, reading);
  onlyOwnAttributes(seed.where, reading.faults);
}

std::optional<GroupSpec> readGroup(const YamlNode& node, const SeedSpec& seed, RuleReading& reading) {
  if (!checkKeys(node, "group", reading.faults)) return std::nullopt;
  GroupSpec group;
  group.at = node.at;
  group.labels = readLabels(node, reading);
  if (group.labels.empty()) group.labels = seed.labels;
  group.near_m = readLength(node, "near", reading);
  group.horizontal_m = readLength(node, "horizontal", reading);
  group.vertical_m = readLength(node, "vertical", reading);
  if (const YamlNode* adjacent = node.find("adjacent"))
    group.adjacent = readFlag(*adjacent, reading.faults).value_or(false);
  const bool has_horizontal = node.find("horizontal") != nullptr;
  if (has_horizontal != (node.find("vertical") != nullptr))
    reading.faults.error(node.at, "'horizontal' and 'vertical' belong together");
  if (node.find("near") == nullptr && !has_horizontal && !group.adjacent)
    reading.faults.error(node.at, "'group' does not say what is linked",
                         "give near, adjacent, or horizontal and vertical");
  if (const YamlNode* limits = node.find("limits"))
    group.limits = readConditions(*limits, {{seed.name}, seed.name}, reading);
  onlyOwnAttributes(group.limits, reading.faults);
  return group;
}

/// The names that the seed and the finds of a rule bind.
std::vector<std::string> namesIn(const Rule& rule) {
  std::vector<std::string> names{rule.seed.name};
  for (const TreeNode& node : rule.nodes)
    if (const auto* find = std::get_if<FindNode>(&node.what))
      if (std::find(names.begin(), names.end(), find->name) == names.end()) names.push_back(find->name);
  return names;
}

/// Such a rule looks at objects of its own class, and a sliced seed cuts primitives: neither can compete.
bool joinsObjects(const Rule& rule) {
  return std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const TreeNode& node) {
    const auto* accept = std::get_if<AcceptLeaf>(&node.what);
    return accept != nullptr && accept->merge_into != MergeInto::Nothing;
  });
}

}  // namespace

std::optional<SliceSpec> readSlice(const YamlNode& node, RuleReading& reading) {
  if (!checkKeys(node, "slice", reading.faults)) return std::nullopt;
  requireKey(node, "from", "slice", reading.faults);
  requireKey(node, "to", "slice", reading.faults);
  const auto from = readLength(node, "from", reading);
  const auto to = readLength(node, "to", reading);
  if (!from || !to) return std::nullopt;
  if (*from >= *to) reading.faults.error(node.at, "'to' is not above 'from'");
  return SliceSpec{*from, *to};
}

std::optional<Rule> readRule(const YamlNode& node, RuleReading& reading) {
  if (!checkKeys(node, "rule", reading.faults)) return std::nullopt;
  Rule rule;
  rule.at = node.at;
  if (const YamlNode* id = requireKey(node, "id", "rule", reading.faults))
    rule.id = readText(*id, "a rule id", reading.faults).value_or("");
  if (const YamlNode* name = requireKey(node, "class", "rule", reading.faults))
    rule.class_iri = readClass(*name, reading).value_or("");
  if (const YamlNode* text = node.find("description"))
    rule.description = readText(*text, "a description", reading.faults).value_or("");
  if (const YamlNode* seed = requireKey(node, "seed", "rule", reading.faults)) readSeed(*seed, rule.seed, reading);
  if (const YamlNode* group = node.find("group")) rule.group = readGroup(*group, rule.seed, reading);
  if (const YamlNode* leftovers = node.find("leftovers"))
    rule.leftovers = readFlag(*leftovers, reading.faults).value_or(false);
  if (const YamlNode* tree = requireKey(node, "tree", "rule", reading.faults)) readTree(*tree, rule, reading);
  if (const YamlNode* evidence = node.find("evidence"))
    rule.evidence = readEvidence(*evidence, {namesIn(rule), rule.seed.name}, reading);
  rule.leftovers = rule.leftovers || rule.seed.slice.has_value() || joinsObjects(rule);
  return rule;
}

}  // namespace cluxel::rules
