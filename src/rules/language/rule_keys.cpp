// SPDX-License-Identifier: Apache-2.0
// The known keys of each mapping of the rule language.
#include <algorithm>
#include <stdexcept>

#include "base/nearest_name.hpp"
#include "rules/language/rule_reading.hpp"
#include "rules/testing/rule_test.hpp"

namespace cluxel::rules {

namespace {

std::vector<std::string> conditionKeys() {
  std::vector<std::string> keys{"of",
                                "attribute",
                                "op",
                                "value",
                                "min",
                                "max",
                                "ratio",
                                "to",
                                "relation",
                                "with",
                                "within",
                                "label",
                                "label_in",
                                "class",
                                "ask",
                                "all",
                                "any",
                                "not",
                                "gap_to",
                                "horizontal_gap_to",
                                "vertical_gap_to",
                                "axis_distance_to",
                                "adjacent_fraction_to",
                                "slice"};
  for (const perception::RelationInfo& relation : perception::relationInfos()) keys.emplace_back(relation.name);
  return keys;
}

}  // namespace

const std::vector<RuleKeyTable>& ruleKeyTables() {
  static const std::vector<RuleKeyTable> tables{
      {"file",
       {"apiVersion", "ruleset", "include", "prefixes", "constants", "define", "order", "nothing", "rules",
        "override"}},
      {"ruleset", {"name", "version", "description"}},
      {"order", {"insert", "before", "after", "beside"}},
      {"override", {"constants", "define", "rules", "remove"}},
      {"rule", {"id", "class", "description", "seed", "group", "leftovers", "evidence", "tree"}},
      {"seed", {"label", "label_in", "as", "slice", "where"}},
      {"slice", {"from", "to"}},
      {"group", {"label", "label_in", "near", "horizontal", "vertical", "adjacent", "limits"}},
      {"node",
       {"test", "all", "any", "not", "ask", "yes", "no", "find", "found", "missing", "accept", "reject", "hint",
        "leave", "unseen"}},
      {"find", {"as", "label", "label_in", "object", "relations", "where", "choose", "share"}},
      {"accept", {"part", "parts", "confidence", "evidence", "absorb", "split", "merge_into"}},
      {"confidence", {"from", "to", "over"}},
      {"ramp", {"of", "attribute", "min", "max"}},
      {"evidence",
       {"measure", "of", "attribute", "slice", "relative_to", "gap_to", "horizontal_gap_to", "vertical_gap_to",
        "axis_distance_to", "adjacent_fraction_to", "when", "curve", "about", "spread", "weight", "missing"}},
      {"absorb", {"from", "when", "max_fraction_of_points", "into", "late"}},
      {"absorb_from", {"label", "label_in"}},
      {"split", {"shared", "from", "reach", "jump", "start", "clearance", "gather"}},
      {"gather", {"within", "above"}},
      {"condition", conditionKeys()},
      {"ratio_to", {"of", "attribute", "slice"}},
      {"target", {"label", "label_in", "object"}},
  };
  return tables;
}

const std::vector<RuleKeyTable>& ruleTestKeyTables() {
  static const std::vector<RuleKeyTable> tables{
      {"test file", {"apiVersion", "rules", "defaults", "tests"}},
      {"defaults", {"ground"}},
      {"ground", {"z"}},
      {"test", {"name", "todo", "like", "primitives", "adjacency", "views", "cloud", "map", "expect"}},
      {"view", {"from", "up_to"}},
      {"primitive", {"label", "box", "attributes"}},
      {"box", {"center", "size", "yaw"}},
      {"expect", {"objects", "exactly", "not", "count", "reasons", "golden", "iou", "min_precision", "min_recall"}},
      {"expected object", {"class", "primitives", "confidence", "rule"}},
      {"expected reason", {"primitive", "rule", "reason"}},
  };
  return tables;
}

namespace {

const RuleKeyTable& tableOf(std::string_view context) {
  for (const auto* tables : {&ruleKeyTables(), &ruleTestKeyTables()})
    for (const RuleKeyTable& table : *tables)
      if (table.context == context) return table;
  throw std::logic_error("no key table named " + std::string(context));
}

bool isKnown(const RuleKeyTable& table, const std::string& key) {
  return std::find(table.keys.begin(), table.keys.end(), key) != table.keys.end();
}

}  // namespace

YamlNode parseRuleYaml(const std::string& file, const std::string& text, FaultList& faults) {
  constexpr std::size_t kMaxBytes = 4U << 20U;
  if (text.size() > kMaxBytes) {
    faults.error({.file = file}, "longer than 4 MiB, which no rule file is");
    return {};
  }
  auto root = parseYaml(file, text, faults);
  if (!root) return {};
  if (root->isNull()) faults.error({.file = file}, "the file is empty");
  return std::move(*root);
}

bool checkKeys(const YamlNode& node, std::string_view context, FaultList& faults) {
  const RuleKeyTable& table = tableOf(context);
  if (!node.isMap()) {
    faults.error(node.at, "'" + std::string(context) + "' must be a mapping, not " + std::string(describeKind(node)),
                 "its keys are: " + table.keys.front() + ", ...");
    return false;
  }
  refuseUnknownKeys(node, table.keys, " in '" + std::string(context) + "'", faults);
  return true;
}

const YamlNode* requireKey(const YamlNode& node, std::string_view key, std::string_view context, FaultList& faults) {
  const YamlNode* value = node.find(key);
  if (value != nullptr && !value->isNull()) return value;
  if (value != nullptr) {
    faults.error(node.keyNode(key)->at, "'" + std::string(key) + "' has no value");
    return nullptr;
  }
  // A mistyped key was reported as unknown: do not report it as missing too.
  const RuleKeyTable& table = tableOf(context);
  for (const YamlNode& given : node.keys)
    if (!isKnown(table, given.text) && nearestName(given.text, table.keys) == key) return nullptr;
  faults.error(node.at, "'" + std::string(context) + "' needs the key '" + std::string(key) + "'");
  return nullptr;
}

}  // namespace cluxel::rules
