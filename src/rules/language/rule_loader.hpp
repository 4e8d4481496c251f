// SPDX-License-Identifier: Apache-2.0
// Loads rule sets from YAML and reports all faults at once.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/error.hpp"
#include "rules/ask_oracle.hpp"
#include "rules/language/class_catalogue.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

struct RuleLoadOptions {
  QueryCheck check_query = {};      ///< absent: the queries of `ask:` are not checked
  QueryClasses query_classes = {};  ///< absent: nothing warns of classes that come later than the query
  bool requires_objects = false;    ///< rules of a class that is not below clx:Object are refused
};

struct LoadedRules {
  std::optional<RuleSet> rules;         ///< absent when there is an error
  std::vector<Diagnostic> diagnostics;  ///< in the order of the files, by line
  /// The rules, or an InputError with all faults.
  RuleSet require() &&;
};

/// Loads one or more rule files (with what they include) as one rule set. Every fault of every file is reported with
/// file:line:col, the line and a hint; a file that cannot be read is a fault too.
LoadedRules loadRules(std::span<const std::filesystem::path> paths, const ClassCatalogue& catalogue,
                      const RuleLoadOptions& options = {});

/// The texts of rule files and of all that they include, without reading what they say. Absent when a file cannot be
/// read or is no YAML, or when files do not fit together: loadRules() tells the faults.
std::optional<std::vector<RuleSource>> readRuleSources(std::span<const std::filesystem::path> paths);

/// Loads rules from texts, as a map stores them: `roots` are loaded, `include` finds the others by name.
LoadedRules loadRuleTexts(std::span<const RuleSource> texts, std::size_t roots, const ClassCatalogue& catalogue,
                          const RuleLoadOptions& options = {});

/// Only the faults.
std::vector<Diagnostic> checkRules(std::span<const std::filesystem::path> paths, const ClassCatalogue& catalogue,
                                   const RuleLoadOptions& options = {});

/// The keys of one mapping of the rule language. A test compares them with the JSON schema.
struct RuleKeyTable {
  std::string_view context;  ///< "rule", "accept", ...
  std::vector<std::string> keys;
};
const std::vector<RuleKeyTable>& ruleKeyTables();

}  // namespace cluxel::rules
