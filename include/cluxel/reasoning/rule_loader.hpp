// SPDX-License-Identifier: Apache-2.0
// Reads rule sets (YAML) and finds all their faults at once.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/reasoning/class_catalogue.hpp"
#include "cluxel/reasoning/rule_set.hpp"

namespace cluxel {

struct RuleLoadOptions {
  /// Says what is wrong with a SPARQL text, or nothing; the offset counts bytes in it. Absent: queries are not checked.
  std::function<std::optional<std::pair<std::size_t, std::string>>(const std::string& query)> check_query;
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

/// The same from texts, as a map stores them: `roots` are loaded, `include` finds the others by name.
LoadedRules loadRuleTexts(std::span<const RuleSource> texts, std::size_t roots, const ClassCatalogue& catalogue,
                          const RuleLoadOptions& options = {});

/// Only the faults.
std::vector<Diagnostic> checkRules(std::span<const std::filesystem::path> paths, const ClassCatalogue& catalogue,
                                   const RuleLoadOptions& options = {});

/// One table per mapping of the language: which keys it takes. The JSON schemas are checked against them.
struct RuleKeyTable {
  std::string_view context;  ///< "rule", "accept", ...
  std::vector<std::string> keys;
};
const std::vector<RuleKeyTable>& ruleKeyTables();

}  // namespace cluxel
