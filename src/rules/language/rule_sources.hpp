// SPDX-License-Identifier: Apache-2.0
// Gathers the files of a rule set: includes, overrides, and the order of classes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/yaml/yaml_tree.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

/// The merged YAML of a rule set before it is interpreted. Every node keeps its file and line.
struct GatheredRules {
  std::string name, version, description;
  std::vector<std::pair<YamlNode, YamlNode>> prefixes, constants;  ///< key, value
  std::vector<std::pair<YamlNode, YamlNode>> definitions;          ///< name, what `use` puts in its place
  std::vector<std::vector<YamlNode>> order;                        ///< strata of class names
  bool is_order_faulty = false;                                    ///< classes that were meant may be missing in it
  std::vector<std::pair<YamlNode, YamlNode>> nothing;              ///< label, log-odds
  std::vector<YamlNode> rules;
  std::vector<RuleSource> sources;  ///< in the order they were read
};

/// Finds and reads a file. `name` is written in the including file, whose key is `from_key` (empty for a root).
struct FoundSource {
  std::string key, shown, text;  ///< key: identifies the file; shown: its name in diagnostics and sources
  std::string fault;
};
using FindSource = std::function<FoundSource(const std::string& name, const std::string& from_key)>;

/// Finds a file beside the including one, whose path is `from_key`.
FoundSource findFile(const std::string& name, const std::string& from_key);

GatheredRules gatherRules(const std::vector<std::string>& roots, const FindSource& findSource, FaultList& faults);

}  // namespace cluxel::rules
