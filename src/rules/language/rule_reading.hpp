// SPDX-License-Identifier: Apache-2.0
// Shared by all readers of rule files: names, constants, faults, and the reading of single values.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.hpp"
#include "rules/language/rule_loader.hpp"

namespace cluxel::rules {

struct RuleConstant {
  Quantity quantity;
  SourceLocation at;
  bool used = false;
  bool faulty = false;                              ///< its definition is faulty and was reported
  std::set<perception::Dimension> misused_as = {};  ///< where it was reported not to fit
};

struct RuleReading {
  const ClassCatalogue& catalogue;
  const RuleLoadOptions& options;
  FaultList& faults;
  std::map<std::string, std::string> prefixes = {};
  std::map<std::string, RuleConstant> constants = {};
  bool asks_map = false;   ///< an `ask:` was read
  std::size_t unread = 0;  ///< values that are missing because of what was reported elsewhere
};

/// The names that a condition may use, and the default subject.
struct NameScope {
  std::vector<std::string> names;
  std::string subject;
};

/// The tree of a rule or rule test file; Null, with a fault, when it is empty, not YAML or longer than 4 MiB.
YamlNode parseRuleYaml(const std::string& file, const std::string& text, FaultList& faults);
/// False, with a fault, when `node` is not a mapping; unknown keys are faults too. `context` names a key table.
bool checkKeys(const YamlNode& node, std::string_view context, FaultList& faults);
/// The value of `key`; a fault when it is missing or empty.
const YamlNode* requireKey(const YamlNode& node, std::string_view key, std::string_view context, FaultList& faults);

/// The items of the list under `key`, empty without the key. Anything but a list is a fault, because it would be
/// ignored silently.
const std::vector<YamlNode>& listUnder(const YamlNode& map, std::string_view key, std::string_view of_what,
                                       FaultList& faults);

std::optional<std::string> readText(const YamlNode& node, std::string_view what, FaultList& faults);
std::optional<bool> readFlag(const YamlNode& node, FaultList& faults);
/// A quantity such as "2.5 m" of any dimension.
std::optional<Quantity> parseQuantity(const YamlNode& node, FaultList& faults);
/// A quantity or $constant of the expected dimension. What is wrong with a constant is reported once.
std::optional<Quantity> readQuantity(const YamlNode& node, perception::Dimension expected, RuleReading& reading);
/// The labels of `label:` or `label_in:`; empty without either.
std::vector<scan::PrimitiveLabel> readLabels(const YamlNode& map, RuleReading& reading);
/// `slice: { from: 0.5 m, to: 1.6 m }`.
std::optional<SliceSpec> readSlice(const YamlNode& node, RuleReading& reading);
/// A class of the catalogue by prefixed name or <IRI>.
std::optional<std::string> readClass(const YamlNode& node, RuleReading& reading);
/// The IRI of a prefixed name or <IRI>, without looking it up.
std::optional<std::string> expandName(const YamlNode& node, RuleReading& reading);
/// A name in scope.
std::optional<std::string> readBoundName(const YamlNode& node, const NameScope& scope, FaultList& faults);
/// A new name: a letter, then letters, digits and underscores; not yet bound.
std::optional<std::string> readNewName(const YamlNode& node, const NameScope& scope, FaultList& faults);

std::optional<Condition> readCondition(const YamlNode& node, const NameScope& scope, RuleReading& reading);
/// The query of an `ask:`, with the names it mentions, into the condition.
void readQuery(const YamlNode& node, const NameScope& scope, RuleReading& reading, Condition& condition);
/// A list of conditions.
std::vector<Condition> readConditions(const YamlNode& node, const NameScope& scope, RuleReading& reading);
/// True when one of the conditions relates `subject` to a bound name, so that candidates can be looked up.
bool tiesToNeighbours(const std::vector<Condition>& conditions, const std::string& subject);

/// The tree below `tree:`; nodes are appended to the rule, the root first.
void readTree(const YamlNode& node, Rule& rule, RuleReading& reading);
std::optional<Rule> readRule(const YamlNode& node, RuleReading& reading);
std::optional<AcceptLeaf> readAccept(const YamlNode& node, const NameScope& scope, const Rule& rule,
                                     RuleReading& reading);

/// The lines of an `evidence:` list. Lines may mention names that only some branches bind.
std::vector<EvidenceLine> readEvidence(const YamlNode& node, const NameScope& scope, RuleReading& reading);
/// What a line of evidence measures: an attribute, also relative to another one, or a measure between two things.
std::optional<Condition> readMeasure(const YamlNode& node, const NameScope& scope, RuleReading& reading);

/// Reports branches that no primitive can reach because the tests before them contradict each other.
void checkReachability(const Rule& rule, FaultList& faults);

}  // namespace cluxel::rules
