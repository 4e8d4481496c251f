// SPDX-License-Identifier: Apache-2.0
// What all readers of rule files share: names, constants, faults, and how single values are read.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/reasoning/rule_loader.hpp"
#include "reasoning/yaml_document.hpp"

namespace cluxel {

struct RuleConstant {
  Quantity quantity;
  SourceLocation at;
  bool used = false;
  bool faulty = false;  ///< already reported where it stands
};

struct RuleReading {
  const ClassCatalogue& catalogue;
  const RuleLoadOptions& options;
  FaultList& faults;
  std::map<std::string, std::string> prefixes = {};
  std::map<std::string, RuleConstant> constants = {};
  bool asks_map = false;  ///< an `ask:` was read
};

/// The names that a condition may use, and the one it means when it gives none.
struct NameScope {
  std::vector<std::string> names;
  std::string subject;
};

/// False, with a fault, when `node` is not a mapping; unknown keys are faults too. `context` names a key table.
bool checkKeys(const YamlNode& node, std::string_view context, FaultList& faults);
/// The value of `key`; a fault when it is missing or empty.
const YamlNode* requireKey(const YamlNode& node, std::string_view key, std::string_view context, FaultList& faults);

/// What the list under `key` holds; a fault when anything else stands there, which would do nothing in silence.
const std::vector<YamlNode>& listUnder(const YamlNode& map, std::string_view key, std::string_view of_what,
                                       FaultList& faults);

std::optional<std::string> readText(const YamlNode& node, std::string_view what, FaultList& faults);
std::optional<bool> readFlag(const YamlNode& node, FaultList& faults);
/// A bare number without unit or constant.
std::optional<double> parseNumber(std::string_view text);
/// "2.5 m" and the like, without regard to what is expected.
std::optional<Quantity> parseQuantity(const YamlNode& node, FaultList& faults);
/// A quantity or $constant of the expected dimension.
std::optional<Quantity> readQuantity(const YamlNode& node, Dimension expected, RuleReading& reading);
/// The labels of `label:` or `label_in:`; empty without either.
std::vector<PrimitiveLabel> readLabels(const YamlNode& map, RuleReading& reading);
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
/// True when one of the conditions ties `subject` to something nearby, so that candidates can be looked up.
bool tiesToNeighbours(const std::vector<Condition>& conditions, const std::string& subject);

/// The tree below `tree:`; nodes are appended to the rule, the root first.
void readTree(const YamlNode& node, Rule& rule, RuleReading& reading);
std::optional<Rule> readRule(const YamlNode& node, RuleReading& reading);
std::optional<AcceptLeaf> readAccept(const YamlNode& node, const NameScope& scope, const Rule& rule,
                                     RuleReading& reading);

/// Branches that no primitive can take, because the tests before them contradict each other.
void checkReachability(const Rule& rule, FaultList& faults);

}  // namespace cluxel
